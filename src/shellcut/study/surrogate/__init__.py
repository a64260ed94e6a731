"""Surfaces through the figures of many runs: how well they predict, and what they are sensitive to.

A surface gives a figure as a function of a few inputs. It knows nothing of runs and of models.
scikit-learn makes it (extra ``study``).
"""
