"""MITC4 shells: strains by tying points, resultants, nodal forces, masses, stresses, frequencies.

May import ``state``, ``mesh``, ``material`` and rows below. ``element`` is one quad by the book,
``forces`` are the kernels that run over all of them, ``shell`` the force term of the simulation.
"""
