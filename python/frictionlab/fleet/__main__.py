"""``python -m frictionlab.fleet`` is the command `friction-fleet`."""

import sys

from .cli import main

sys.exit(main())
