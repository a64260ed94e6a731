"""Results of a run, read back: frames, history, splits, verdict, comparison of curves.

May import ``view``, ``frame``, ``formats``, ``files`` and rows below; nothing here runs a
simulation.
"""

from .comparison import Comparison, compare
from .measured_curve import MeasuredCurve, read_measured_curve
from .run_results import Results, read

__all__ = ["Comparison", "MeasuredCurve", "Results", "compare", "read", "read_measured_curve"]
