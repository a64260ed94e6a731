"""shellcut: a sharp rigid blade cuts a thin shell.

Explicit dynamics of MITC4 shells with directional cohesive cables and penalty contact, after
Frangi, Pagani, Perego and Borsari (CMES 57, 2010). Units throughout: mm, N, s, tonne, MPa.

A model is built by hand from a :class:`Mesh`, a :class:`ShellMaterial`, supports, loads, a
:class:`Tool` with a motion and a :class:`CohesiveLaw`, put into a :class:`Simulation` and run;
:func:`opening_test`, :func:`guillotine`, :func:`trouser` and :func:`oscillating` are ready models.

In the code a *row* is a row of the table of quads: a quad of the mesh, or one of the copies that
take its place where a crack goes through it.
"""

from .signals import Importing

with Importing():
    from . import meshing, tool_shapes
    from .cables.cohesive_law import CohesiveLaw, CohesiveTable
    from .checks import check_model
    from .contact.settings import Contact
    from .files.distribution import VERSION
    from .fracture.anisotropy import Anisotropy
    from .fracture.options import Fracture
    from .loads.adhesion import Adhesion
    from .loads.loads import EdgeTraction, Gravity, NodalForce, NodalMoment, Pressure
    from .loads.supports import Support
    from .material import (
        CowperSymonds,
        Elastic,
        Hencky,
        JohnsonCook,
        Layer,
        Linear,
        Orthotropic,
        Plastic,
        ShellMaterial,
        Swift,
        Table,
        Voce,
    )
    from .mesh.drawing import FilmOutline, mesh_from_drawing, read_drawing
    from .mesh.film_file import read_film
    from .mesh.mesh import Mesh
    from .mesh.outline import mesh_from_outline
    from .mitc4.mesh_quality import mesh_quality
    from .model_file import ModelFileError, preset_film, read_model
    from .models import guillotine, opening_test, oscillating, trouser
    from .models.path_film import film_along_path
    from .models.preview import preview
    from .models.warmup import warmup
    from .recording.checkpoint import load_checkpoint, save_checkpoint
    from .recording.recorder import Recorder
    from .report import report_run
    from .results.comparison import Comparison, compare
    from .results.error_bars import ErrorBar, ErrorBars
    from .results.measured_curve import MeasuredCurve, read_measured_curve
    from .results.run_results import Results, read
    from .scene_page import view_html
    from .simulation.hooks import Hook, StopRun
    from .simulation.simulation import Simulation
    from .simulation.stable_step import Stepping
    from .statics.statics import Statics
    from .study.converge import converge
    from .study.curve_misfit import FitCurve
    from .study.factors import Design
    from .study.fit import Search, fit
    from .study.optimise import Optimum, optimise
    from .study.report import report_study
    from .study.study import StudyResults, sweep
    from .tensile import TensileTest, evaluate_tensile
    from .tool.force_term import ForceTerm
    from .tool.motion import ScrewMotion, StraightMotion
    from .tool.table_motion import TableMotion
    from .tool.tool import Tool
    from .tool.tool_file import read_tool
    from .tool.touch import Booking, Touch
    from .unit import showing

__version__ = VERSION

__all__ = [
    "Adhesion",
    "Anisotropy",
    "Booking",
    "CohesiveLaw",
    "CohesiveTable",
    "Comparison",
    "Contact",
    "CowperSymonds",
    "Design",
    "EdgeTraction",
    "Elastic",
    "ErrorBar",
    "ErrorBars",
    "FilmOutline",
    "FitCurve",
    "ForceTerm",
    "Fracture",
    "Gravity",
    "Hencky",
    "Hook",
    "JohnsonCook",
    "Layer",
    "Linear",
    "MeasuredCurve",
    "Mesh",
    "ModelFileError",
    "NodalForce",
    "NodalMoment",
    "Optimum",
    "Orthotropic",
    "Plastic",
    "Pressure",
    "Recorder",
    "Results",
    "ScrewMotion",
    "Search",
    "ShellMaterial",
    "Simulation",
    "Statics",
    "Stepping",
    "StopRun",
    "StraightMotion",
    "StudyResults",
    "Support",
    "Swift",
    "Table",
    "TableMotion",
    "TensileTest",
    "Tool",
    "Touch",
    "Voce",
    "check_model",
    "compare",
    "converge",
    "evaluate_tensile",
    "film_along_path",
    "fit",
    "guillotine",
    "load_checkpoint",
    "mesh_from_drawing",
    "mesh_from_outline",
    "mesh_quality",
    "meshing",
    "opening_test",
    "optimise",
    "oscillating",
    "preset_film",
    "preview",
    "read",
    "read_drawing",
    "read_film",
    "read_measured_curve",
    "read_model",
    "read_tool",
    "report_run",
    "report_study",
    "save_checkpoint",
    "showing",
    "sweep",
    "tool_shapes",
    "trouser",
    "view_html",
    "warmup",
]
