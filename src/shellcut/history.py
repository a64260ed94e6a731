"""The table of ``history.csv``; the code is in :mod:`shellcut.results.history`."""

from .results.history import HistoryWriter, Written, read_history

__all__ = ["HistoryWriter", "Written", "read_history"]
