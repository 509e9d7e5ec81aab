"""Many recordings at once: bags and tables of a whole fleet to one Parquet dataset and one page.

`run` identifies every recording of a folder, a pattern or a table of addresses, here or in an object store, on
all cores or on a Ray cluster. `read` opens what a run has written. The command is `friction-fleet`, or
``python -m frictionlab.fleet``. `frictionlab.fleet.search` does one long computation in shares on the same engines.

>>> from frictionlab import fleet
>>> fleet.Settings({"model": "lugre"}).longest_s
600.0
"""

from .drift import Change, changes
from .fleet import Fleet, read
from .pooled import Pooled, pooled
from .run import run
from .settings import Settings
from .sources import Recording, recordings

__all__ = ["Change", "Fleet", "Pooled", "Recording", "Settings", "changes", "pooled", "read", "recordings", "run"]
