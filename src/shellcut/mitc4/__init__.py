"""MITC4 shells: strains by tying points, resultants, nodal forces, masses, stresses, frequencies.

May import ``state``, ``mesh``, ``material`` and the layers below. ``element`` is the formulation of
one quad, ``forces`` has the kernels over all quads, ``shell`` is the force term of the simulation.
"""
