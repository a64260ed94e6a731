"""The report of a run: one HTML file that opens from disk, on a phone and on paper."""

from .report import report

__all__ = ["report"]
