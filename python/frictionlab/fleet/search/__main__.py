"""``python -m frictionlab.fleet.search`` is the command `friction-search`."""

import sys

from .cli import main

sys.exit(main())
