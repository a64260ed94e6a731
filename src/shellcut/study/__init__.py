"""Studies: many runs of one model with other values, their table, and what follows from it.

A study is a model, factors with their values, and a design. Each run has a folder of its own, found
again by a hash of its inputs; they go one after the other, on processes of this machine, or on any
engine that takes tasks (Dask). May import model files and everything below them.
"""
