"""Output of a running simulation: frames, history, checkpoints, pictures, summary, progress.

May import ``results``, ``checks``, the physics (``fracture``) and the layers below. The simulation
calls the recorder as a hook and hands itself in: recording reads it and names only its type.
``recorder`` calls the other files in order; :mod:`shellcut.results` describes every file written.
"""
