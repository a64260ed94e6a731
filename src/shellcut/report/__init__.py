"""The report of a run: one HTML file that opens from disk, on a phone and on paper.

May import ``results``, ``view`` and the layers below.
"""

from .report import report_run

__all__ = ["report_run"]
