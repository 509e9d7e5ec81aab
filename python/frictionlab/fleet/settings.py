"""How every recording of a fleet is identified."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .. import __version__
from .._given import options
from ..errors import BadInput

# A change of the columns, or of what they mean.
FORMAT = 1
MEGABYTE = 1_000_000


@dataclass(frozen=True)
class Settings:
    """How a recording becomes rows: the same for all, on whichever machine."""

    # Keywords of `identify`, as model="lugre".
    keywords: Mapping[str, Any] = field(default_factory=dict)
    # What opens the store, as {"endpoint_url": "http://127.0.0.1:9000"}; it is kept in no result.
    storage: Mapping[str, Any] = field(default_factory=dict)
    # A recording that takes longer [s] is given up.
    longest_s: float = 600.0
    # A recording that is larger [bytes] is not read.
    largest_bytes: int = 4000 * MEGABYTE

    def __post_init__(self) -> None:
        if not 0.0 < self.longest_s <= 1e6:
            raise BadInput(f"the longest time for a recording must be above 0 s and at most 1e6 s, but is {self.longest_s}")
        if self.largest_bytes < 1:
            raise BadInput(f"the largest recording must have a byte at least, but is {self.largest_bytes}")
        for held in ("validate", "data"):
            if held in self.keywords:
                raise BadInput(f"`{held}` is the same for no two recordings; identify takes it, a fleet does not")

    @property
    def key(self) -> str:
        """What the rows of a recording depend on besides its content: rows of another key are made anew."""
        keywords = {name: value for name, value in self.keywords.items() if (name, value) != ("joint", "all")}
        told = {"format": FORMAT, "version": __version__, "options": sorted(options(keywords))}
        text = json.dumps(told, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]
