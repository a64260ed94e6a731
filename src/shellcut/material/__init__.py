"""What the film is made of: layers, their elastic laws, and the stress at a point.

May import ``numerics`` and rows below.
"""

from .shell_material import Elastic, Layer, ShellMaterial

__all__ = ["Elastic", "Layer", "ShellMaterial"]
