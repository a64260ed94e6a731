"""shellcut: a sharp rigid blade cuts a thin shell.

Explicit dynamics of MITC4 shells with directional cohesive cables and penalty contact, after
Frangi, Pagani, Perego and Borsari (CMES 57, 2010). Units throughout: mm, N, s, tonne, MPa.

A model is built by hand from a :class:`Mesh`, a :class:`ShellMaterial`, supports, loads, a
:class:`Tool` with a motion and a :class:`CohesiveLaw`, put into a :class:`Simulation` and run;
:func:`opening_test` and :func:`guillotine` are ready models.
"""

from importlib.metadata import version

from .checkpoint import load_checkpoint, save_checkpoint
from .checks import check_model
from .cohesive_law import CohesiveLaw
from .comparison import Comparison, compare
from .criterion import Fracture
from .film_file import read_film
from .imprinting import ImprintError, ImprintResult, PathCurve, blade_path, imprint
from .load import EdgeTraction, Gravity, NodalForce, NodalMoment, Pressure
from .material import ShellMaterial
from .measured_curve import MeasuredCurve, read_measured_curve
from .mesh import Mesh
from .model_file import ModelFileError, read_model
from .models import guillotine, opening_test
from .motion import ScrewMotion, StraightMotion
from .outline_mesh import mesh_from_outline
from .penalty import Contact
from .preview import preview
from .quality import mesh_quality
from .recorder import Recorder
from .report import report
from .results import Results, read
from .simulation import Simulation
from .statics import Statics
from .support import Support
from .table_motion import TableMotion
from .time_step import Stepping
from .tool import Tool
from .tool_file import read_tool
from .warmup import warmup

__version__ = version("shellcut")

__all__ = [
    "CohesiveLaw",
    "Comparison",
    "Contact",
    "EdgeTraction",
    "Fracture",
    "Gravity",
    "ImprintError",
    "ImprintResult",
    "MeasuredCurve",
    "Mesh",
    "ModelFileError",
    "NodalForce",
    "NodalMoment",
    "PathCurve",
    "Pressure",
    "Recorder",
    "Results",
    "ScrewMotion",
    "ShellMaterial",
    "Simulation",
    "Statics",
    "Stepping",
    "StraightMotion",
    "Support",
    "TableMotion",
    "Tool",
    "blade_path",
    "check_model",
    "compare",
    "guillotine",
    "imprint",
    "load_checkpoint",
    "mesh_from_outline",
    "mesh_quality",
    "opening_test",
    "preview",
    "read",
    "read_film",
    "read_measured_curve",
    "read_model",
    "read_tool",
    "report",
    "save_checkpoint",
    "warmup",
]
