"""The explicit simulation: the order of a step, its length, the energy balance, relaxation, hooks.

May import the physics (``fracture`` and the layers below). ``simulation.Simulation.step`` is the
step on one screen. Contact, cables and further forces are classes after
``tool.force_term.ForceTerm``; ``force_terms`` evaluates them.
"""
