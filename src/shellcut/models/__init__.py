"""Ready models: opening test, guillotine, trouser, oscillating cut, free cut of any film.

May import ``recording`` and the layers below.
"""

from .case import Case
from .free_cut import free_cut
from .guillotine import guillotine
from .opening import opening_test
from .oscillating import oscillating
from .trouser import trouser

__all__ = ["Case", "free_cut", "guillotine", "opening_test", "oscillating", "trouser"]
