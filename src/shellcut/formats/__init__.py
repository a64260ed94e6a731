"""Files of meshes, surfaces and tables, read as they are: ids, groups and numbers, no physics.

A reader returns what the file holds, or raises :class:`FileError`. What is declared (counts, ends
of sections) is compared with what is read, so that a truncated file is refused. What a film or a
tool makes of it is decided in :mod:`shellcut.mesh.film_file` and :mod:`shellcut.tool.tool_file`.

May import ``arrays``, ``unit`` and ``files``.
"""
