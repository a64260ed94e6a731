"""The report of a study, a fit or a search: one HTML file about all its runs.

It reads the table and the histories, so it shows a study that is still running, too.
"""

from .report import report_found, report_study

__all__ = ["report_found", "report_study"]
