"""Damaged files and nonsense numbers: what becomes of them. ``python -m damaged`` counts it."""
