"""One recording identified: the work of a process, on whichever machine it runs."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ..errors import BadInput
from ..identification import Identification, each_or_whole, identify_joints
from .reading import content
from .settings import Settings
from .sources import Recording


class Task(NamedTuple):
    """A recording to be identified."""

    recording: Recording
    # The hash that it had when it was last identified in this way: if it has it still, nothing is to be done.
    known: str | None = None


@dataclass(frozen=True)
class Outcome:
    """What came of a recording."""

    uri: str
    # None where it could not be read.
    hash: str | None = None
    bytes: int | None = None
    # Why there is nothing, or none where there is.
    error: str | None = None
    # It is what it was when it was last identified.
    unchanged: bool = False
    # Columns of the dataset by name, a row a parameter of each model of each joint.
    rows: list[dict[str, Any]] = field(default_factory=list)


@dataclass(frozen=True)
class Identifying:
    """The work of an engine (see `engines.Work`) whose tasks are recordings."""

    settings: Settings

    @property
    def longest_s(self) -> float:
        """A recording that takes longer is given up [s]."""
        return self.settings.longest_s

    def do(self, task: Task) -> Outcome:
        """Identifies it."""
        return outcome(self.settings, task)

    def failed(self, task: Task, why: str) -> Outcome:
        """The outcome of a recording that nobody could identify."""
        return Outcome(task.recording.uri, error=f"{task.recording.uri}: {why}")


class _TooLongError(Exception):
    pass


def outcome(settings: Settings, task: Task) -> Outcome:
    """Reads and identifies a recording. Whatever is wrong with it is told in the outcome."""
    uri = task.recording.uri
    digest: str | None = None
    size: int | None = None
    try:
        with _limited(settings.longest_s), content(uri, settings) as read:
            digest, size = read.hash, read.bytes
            if digest == task.known:
                return Outcome(uri, digest, size, unchanged=True)
            rows = _identified(str(read.path), uri, settings)
            return Outcome(uri, digest, size, rows=rows)
    except _TooLongError:
        error = f"{uri}: it took longer than {settings.longest_s:g} s; allow more with --longest"
    except BadInput as bad:
        error = str(bad)
    except MemoryError:
        error = f"{uri}: it does not fit into the memory"
    except Exception as unexpected:  # one recording is no reason to lose the others
        error = f"{uri}: {type(unexpected).__name__}: {unexpected}"
    return Outcome(uri, digest, size, error)


def _identified(path: str, uri: str, settings: Settings) -> list[dict[str, Any]]:
    keywords = dict(settings.keywords)
    joint = keywords.pop("joint", "all")
    if keywords.get("model"):
        # The recordings are what runs side by side.
        keywords.setdefault("jobs", 1)
    try:
        found = each_or_whole(path, keywords) if joint == "all" else identify_joints(path, joint, **keywords)
    except BadInput as bad:
        raise BadInput(str(bad).replace(path, uri)) from None
    rows = [row for name, one in found.items() for row in _rows(name, one)]
    rows += [{"joint_inside": name or None, "error": why.replace(path, uri)} for name, why in found.failed.items()]
    return rows


def _rows(joint: str, found: Identification) -> Iterator[dict[str, Any]]:
    warnings = "\n".join(found.warnings) or None
    best = found.best.name
    for fit in found.models.values():
        for name, estimate in fit.parameters.items():
            low, high = estimate.interval_95 or (None, None)
            yield {
                "joint_inside": joint or None,
                "model": fit.name,
                "chosen": fit.name == best,
                "parameter": name,
                "value": estimate.value,
                "unit": estimate.unit,
                "standard_error": estimate.standard_error,
                "low_95": low,
                "high_95": high,
                "identified": estimate.identified,
                "verdict": estimate.verdict or None,
                "fit_error": fit.error,
                "fit_error_unit": fit.error_unit,
                "warnings": warnings,
            }


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """Ends what takes longer, as ctrl-C would; on the main thread of systems that have such a clock."""
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def ends(*_: object) -> None:
        raise _TooLongError

    before = signal.signal(signal.SIGALRM, ends)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
