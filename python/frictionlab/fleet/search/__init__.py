"""One long computation in shares: Monte-Carlo draws, truth matrices, trials and searches over seeds.

`search` cuts the work of a command into shares, lets the cores of this machine or a Ray cluster do them, and lets the
command itself join what they found, so that the result is that of one process, bit for bit. The command line is
``friction-search``, or ``python -m frictionlab.fleet.search``.
"""

from .run import Searched, search
from .share import Found, Share

__all__ = ["Found", "Searched", "Share", "search"]
