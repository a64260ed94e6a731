"""How clean a cut is; the code is in :mod:`shellcut.results.cut_quality`."""

from .results.cut_quality import UNITS, Bridge, CutQuality, Part, Piece, cut_quality

__all__ = ["UNITS", "Bridge", "CutQuality", "Part", "Piece", "cut_quality"]
