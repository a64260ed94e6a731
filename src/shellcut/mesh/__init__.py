"""The film as quadrilaterals: read from a file, made from an outline or on a grid, and checked.

May import ``numerics``, ``formats`` and the layers below.
"""
