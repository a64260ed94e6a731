"""Material of the film: layers, their material laws, and the stress at a point.

May import ``numerics`` and the layers below.
"""

from .elastic import Elastic
from .hardening import Linear, Swift, Table, Voce
from .hencky import Hencky
from .material import Material
from .material_point import MaterialPoint, PointState
from .orthotropic import Orthotropic
from .plastic import Plastic
from .point_law import LAWS, PointLaw, register
from .rate_factor import CowperSymonds, JohnsonCook
from .shell_material import Layer, ShellMaterial

__all__ = [
    "LAWS",
    "CowperSymonds",
    "Elastic",
    "Hencky",
    "JohnsonCook",
    "Layer",
    "Linear",
    "Material",
    "MaterialPoint",
    "Orthotropic",
    "Plastic",
    "PointLaw",
    "PointState",
    "ShellMaterial",
    "Swift",
    "Table",
    "Voce",
    "register",
]
