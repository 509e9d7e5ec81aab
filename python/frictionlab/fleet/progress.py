"""How far a run is."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field
from typing import TextIO


def counted(number: int, what: str) -> str:
    """So many of them, in words.

    >>> counted(1, "recording"), counted(2, "recording")
    ('1 recording', '2 recordings')
    """
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


@dataclass
class Count:
    """Recordings of a run, or shares of a search."""

    # All of them.
    of: int
    # What one of them is called.
    what: str
    # Done in this run, or found to be unusable.
    done: int = 0
    # Known from a run before.
    kept: int = 0
    # Of those done, how many could not be used.
    failed: int = 0
    began: float = field(default_factory=time.monotonic)

    def __str__(self) -> str:
        seconds = max(time.monotonic() - self.began, 1e-3)
        left = (self.of - self.kept - self.done) * seconds / max(self.done, 1)
        failed = f", {self.failed} not usable" if self.failed else ""
        kept = f", {self.kept} known from before" if self.kept else ""
        through = f"{self.done + self.kept} of {counted(self.of, self.what)}"
        return f"{through}{kept}{failed}, {self.done / seconds:.1f} a second, {_span(left)} left"


class Shown:
    """Tells it on standard error: one line that changes on a terminal, a line now and then elsewhere."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stderr
        self._terminal = self._stream.isatty()
        self._every = 0.2 if self._terminal else 10.0
        self._told = time.monotonic()
        self._line = False

    def __call__(self, count: Count) -> None:
        """Tells it, if it is time to."""
        now = time.monotonic()
        if now - self._told < self._every:
            return
        self._told = now
        self._stream.write(f"\r\x1b[K{count}" if self._terminal else f"{count}\n")
        self._stream.flush()
        self._line = self._terminal

    def end(self) -> None:
        """Ends the line."""
        if self._line:
            self._stream.write("\n")
            self._line = False


def _span(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
