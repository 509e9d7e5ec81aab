"""What an engine costs a recording, and what a second worker is worth."""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

from ..run import run
from .made import recording


class Timed(NamedTuple):
    """A run over made recordings."""

    engine: str
    workers: int
    recordings: int
    seconds: float
    # Resident memory of this process at most [MB].
    memory_mb: float


def timed(engine: str, workers: int, count: int, **keywords: Any) -> Timed:
    """Identifies made recordings; starting the processes is not counted, the first recordings are."""
    with tempfile.TemporaryDirectory(prefix="friction-fleet-") as name:
        folder = Path(name) / "recordings"
        folder.mkdir()
        for seed in range(count):
            (folder / f"{seed:06d}.csv").write_bytes(recording(seed))
        seen: list[tuple[float, int]] = []
        run(
            folder,
            Path(name) / "out",
            engine=engine,
            workers=workers,
            on_progress=lambda at: seen.append((time.monotonic(), at.done)),
            **keywords,
        )
    # Until every process has answered twice, some still start.
    first = min(4 * workers, len(seen) - 1)
    seconds = (seen[-1][0] - seen[first][0]) * count / (seen[-1][1] - seen[first][1])
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)
    return Timed(engine, workers, count, seconds, peak)


def table(engines: list[str], count: int, **keywords: Any) -> str:
    """Engines with one and two workers as a table in Markdown."""
    lines = ["| engine | workers | recordings | ms a recording | speed-up | memory of the driver |", "|---|---|---|---|---|---|"]
    for engine in engines:
        found = [timed(engine, workers, count, **keywords) for workers in (1, 2)]
        for one in found:
            faster = f"{found[0].seconds / one.seconds:.2f}" if one.workers > 1 else ""
            each = 1000.0 * one.seconds / one.recordings
            lines.append(f"| {engine} | {one.workers} | {count} | {each:.2f} | {faster} | {one.memory_mb:.0f} MB |")
    return "\n".join(lines)
