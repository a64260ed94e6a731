"""Static equilibrium of the same shells: Newton, load paths through snaps, vibration modes.

May import the physics (``mitc4``, ``loads`` and the layers below).
"""
