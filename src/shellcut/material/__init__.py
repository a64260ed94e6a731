"""Material of the film: layers, their material laws, and the stress at a point.

May import ``numerics`` and rows below.
"""

from .elastic import Elastic
from .material import Material
from .point_law import LAWS, PointLaw, register
from .shell_material import Layer, ShellMaterial

__all__ = ["LAWS", "Elastic", "Layer", "Material", "PointLaw", "ShellMaterial", "register"]
