"""Ready models: opening test, guillotine, trouser test, and a free cut of any film.

May import ``recording`` and rows below.
"""

from .case import Case
from .free_cut import free_cut
from .guillotine import guillotine
from .opening import opening_test
from .trouser import trouser

__all__ = ["Case", "free_cut", "guillotine", "opening_test", "trouser"]
