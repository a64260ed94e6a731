"""What the command ends with."""

DONE, BAD_INPUT, STOPPED, INTERRUPTED = 0, 2, 3, 130
"""Done; bad arguments or model; a guard stopped the run; Ctrl-C, as shells count it."""
