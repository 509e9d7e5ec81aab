"""One share of a search: a part of a command's work, done by its program."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

GUARD = Path(__file__).with_name("guard.py")
# How long a program that is to end is waited for [s].
ENDS = 10.0


class Found(NamedTuple):
    """What came of a share."""

    # From 1 on.
    number: int
    # What the program printed: a document that `--join` understands. None where there is none.
    document: bytes | None = None
    # Why.
    error: str | None = None
    # The program says that it was asked for something that there is not: so would every share.
    refused: bool = False


@dataclass(frozen=True)
class Share:
    """The work of an engine (see `engines.Work`) whose tasks are the numbers of shares, from 1 on."""

    # The program and its options.
    command: tuple[str, ...]
    # Number of shares.
    of: int
    # A share that takes longer is given up [s].
    longest_s: float
    # Where the program is started, where there is such a folder.
    folder: str

    def do(self, task: int) -> Found:
        """Lets the program do it."""
        jobs = [] if any(word.split("=")[0] == "--jobs" for word in self.command) else ["--jobs", "1"]
        line = [*self.command, *jobs, "--part", f"{task}/{self.of}", "--json", "--quiet"]
        try:
            return self._ran(task, line)
        except subprocess.TimeoutExpired:
            return self.failed(task, f"it took longer than {self.longest_s:g} s; allow more with --longest")
        except OSError as error:
            return self.failed(task, str(error))

    def failed(self, task: int, why: str) -> Found:
        """The outcome of a share that came to nothing."""
        return Found(task, error=f"share {task} of {self.of}: {why}")

    def _ran(self, task: int, line: list[str]) -> Found:
        ours, theirs = os.pipe()
        with os.fdopen(theirs, "wb") as held:
            try:
                guard = subprocess.Popen(
                    [sys.executable, "-I", "-S", str(GUARD), *line],
                    stdin=ours,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE,
                    cwd=self.folder if Path(self.folder).is_dir() else None,
                )
            finally:
                os.close(ours)
            try:
                document, said = guard.communicate(timeout=self.longest_s)
            except BaseException:
                # The guard ends the program, and itself.
                held.close()
                try:
                    guard.communicate(timeout=ENDS)
                except subprocess.TimeoutExpired:
                    guard.kill()
                raise
        if guard.returncode == 0 and document.strip():
            return Found(task, document)
        words = said.decode(errors="replace").strip().splitlines()
        why = words[-1] if words else f"{line[0]} ended with code {guard.returncode} and printed nothing"
        return self.failed(task, why)._replace(refused=guard.returncode == 2)
