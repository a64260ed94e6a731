"""Results of a run, read back: frames, history, splits, verdict, comparison of curves.

May import ``view``, ``frame``, ``formats``, ``files`` and the layers below; nothing here runs a
simulation.
"""
