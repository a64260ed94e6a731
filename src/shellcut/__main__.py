"""``python -m shellcut``: the ``shellcut`` command."""

from .command_line import main

raise SystemExit(main())
