"""Is anything lost, or silently wrong: trials of the promises, all by run.py."""
