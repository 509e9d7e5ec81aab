"""How every command of the package ends: 0 done, 1 not achieved, 2 wrong input with a sentence, 130 interrupted."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from typing import TextIO


class AnalysisError(Exception):
    """Something that the user can mend; the text says what was expected, what came and how to mend it."""


def command(name: str, text: str) -> argparse.ArgumentParser:
    """Parser of a command whose help shows `text`, the module's documentation, as it is written."""
    return argparse.ArgumentParser(
        prog=name, description=text.strip(), formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )


def positive(text: str) -> float:
    """Reads an argument that must be a finite number above zero."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"a number above 0 was expected, but {text!r} came")
    return value


def conclude(work: Callable[[], int]) -> int:
    """Runs a command's work and turns what went wrong into a sentence and an exit code."""
    try:
        return work()
    except (AnalysisError, OSError) as error:
        if isinstance(error, BrokenPipeError):
            # Whoever read our output has gone; nothing is left to tell.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 0
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


class Progress:
    """Tells on standard error how far work is: one line that changes on a terminal, a line now and then elsewhere."""

    def __init__(self, what: str, stream: TextIO | None = None, every: float = 2.0) -> None:
        self._what = what
        self._stream = stream or sys.stderr
        self._every = 0.1 if self._stream.isatty() else every
        self._told = time.monotonic()
        self._line = False

    def __call__(self, share: float) -> None:
        """`share` is done, 0 to 1."""
        if time.monotonic() - self._told >= self._every or (share >= 1.0 and self._line):
            self._told = time.monotonic()
            self._line = share < 1.0
            text = f"{self._what}: {100.0 * share:.0f} %"
            if self._stream.isatty():
                print(f"\r{text:<60}", end="" if share < 1.0 else "\n", file=self._stream, flush=True)
            else:
                print(text, file=self._stream, flush=True)
