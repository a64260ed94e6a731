"""The explicit simulation: the order of a step, its length, the energy balance, relaxation, hooks.

May import the physics (``fracture`` and rows below). ``simulation.Simulation.step`` is the step on
one screen.
"""
