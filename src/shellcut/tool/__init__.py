"""The rigid tool: surface, cutting edges, motion, and the distance of points from it.

May import ``numerics``, ``formats`` and the layers below. A tool consists of triangles; some of
their edges may cut.
"""
