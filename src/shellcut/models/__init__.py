"""Ready models: the opening test of the paper and the guillotine."""

from .case import Case
from .guillotine import guillotine
from .opening import opening_test

__all__ = ["Case", "guillotine", "opening_test"]
