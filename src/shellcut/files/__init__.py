"""Safe files of a run: complete or absent, one run per folder, only the run's own files replaced.

Imports no other package. :mod:`shellcut.formats` and :mod:`shellcut.results` know the contents; the
files here write them to disk completely, lock the folder and list the files.
"""
