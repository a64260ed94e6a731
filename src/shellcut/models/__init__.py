"""Ready models: the opening test of the paper, the guillotine, and a free cut of any film.

May import ``recording`` and rows below.
"""

from .case import Case
from .free_cut import free_cut
from .guillotine import guillotine
from .opening import opening_test

__all__ = ["Case", "free_cut", "guillotine", "opening_test"]
