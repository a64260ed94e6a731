"""Files of a run that nobody can damage: whole or not at all, one run a folder, only what is ours.

Imports no other room. What a file holds is the business of :mod:`shellcut.formats` and
:mod:`shellcut.results`; here is how it gets onto the disk: in one piece, locked, listed.
"""
