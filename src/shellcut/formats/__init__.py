"""Readers of mesh, surface and table files: ids, groups and numbers as they are, no physics.

A reader returns the content of a file, or raises :class:`FileError`. Declared counts and ends of
sections are compared with the content, so that a truncated file is refused.
:mod:`shellcut.mesh.film_file` and :mod:`shellcut.tool.tool_file` build films and tools from it.

May import ``arrays``, ``unit`` and ``files``.
"""
