"""What an engine costs a recording, and what a second worker is worth."""

from __future__ import annotations

import hashlib
import resource
import sys
import tempfile
import time
from collections.abc import Generator, Iterable
from pathlib import Path
from typing import Any, NamedTuple

from ..needs import needed
from ..run import run
from ..work import Outcome, Task
from .made import recording


class Timed(NamedTuple):
    """A run over made recordings."""

    engine: str
    workers: int
    recordings: int
    seconds: float
    # Resident memory of this process at most [MB].
    memory_mb: float


def timed(engine: str, workers: int, count: int, points: int = 40, **keywords: Any) -> Timed:
    """Identifies made recordings; starting the processes is not counted, the first recordings are."""
    with tempfile.TemporaryDirectory(prefix="friction-fleet-") as name:
        folder = Path(name) / "recordings"
        folder.mkdir()
        for seed in range(count):
            (folder / f"{seed:06d}.csv").write_bytes(recording(seed, points=points))
        seen: list[tuple[float, int]] = []
        if engine == "ray":
            # A cluster of so many processors, each with work to come.
            needed("ray", "ray").init(
                "local", num_cpus=workers, include_dashboard=False, log_to_driver=False, logging_level="error"
            )
        run(
            folder,
            Path(name) / "out",
            engine=engine,
            workers=None if engine == "ray" else workers,
            on_progress=lambda at: seen.append((time.monotonic(), at.done)),
            **keywords,
        )
    if engine == "ray":
        needed("ray", "ray").shutdown()
    # Until every process has answered twice, some still start.
    first = min(4 * workers, len(seen) - 1)
    seconds = (seen[-1][0] - seen[first][0]) * count / (seen[-1][1] - seen[first][1])
    return Timed(engine, workers, count, seconds, _peak_mb())


def _peak_mb() -> float:
    """Resident memory of this process at most."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)


class _Nothing:
    """Gives each recording the same rows at once: what is left is the work of the driver."""

    workers = 1

    def outcomes(self, tasks: Iterable[Task]) -> Generator[Outcome, None, None]:
        for task in tasks:
            digest = hashlib.sha256(task.recording.uri.encode()).hexdigest()
            row = {"model": "made", "chosen": True, "value": 1.0, "standard_error": 0.1, "unit": "N m", "identified": True}
            rows = [row | {"parameter": name} for name in ("f_c", "f_s", "v_s", "f_v")]
            yield Outcome(task.recording.uri, digest, 2000, rows=rows)


def driver(count: int) -> str:
    """What the driver itself needs: time and memory for so many recordings of four parameters."""
    import pandas as pd

    machines = [f"arm{at % 500}" for at in range(count)]
    table = pd.DataFrame({"uri": [f"s3://made/{at:08d}.csv" for at in range(count)], "machine": machines})
    times: list[float] = []
    with tempfile.TemporaryDirectory(prefix="friction-fleet-") as name:
        before, began = _peak_mb(), time.monotonic()
        run(table, Path(name) / "out", engine=_Nothing(), on_progress=lambda _: times.append(time.monotonic()))
        through, whole = times[-1] - began, time.monotonic() - began
        size = sum(file.stat().st_size for file in Path(name).rglob("*.parquet")) / 1e6
    lines = ["| recordings | ms a recording | with the page | memory of the driver | of that for recordings | dataset |"]
    lines += ["|---|---|---|---|---|---|"]
    each, page, peak = 1000.0 * through / count, 1000.0 * whole / count, _peak_mb()
    lines.append(f"| {count} | {each:.3f} | {page:.3f} | {peak:.0f} MB | {peak - before:.0f} MB | {size:.1f} MB |")
    return "\n".join(lines)


def table(engines: list[str], count: int, points: int = 40, repeats: int = 3, **keywords: Any) -> str:
    """Engines with one and two workers as a table in Markdown; the fastest of several runs in turn."""
    lines = ["| engine | workers | recordings | ms a recording | speed-up | memory of the driver |", "|---|---|---|---|---|---|"]
    for engine in engines:
        runs = [[timed(engine, workers, count, points, **keywords) for workers in (1, 2)] for _ in range(repeats)]
        found = [min(several, key=lambda one: one.seconds) for several in zip(*runs, strict=True)]
        for one in found:
            faster = f"{found[0].seconds / one.seconds:.2f}" if one.workers > 1 else ""
            each = 1000.0 * one.seconds / one.recordings
            lines.append(f"| {engine} | {one.workers} | {count} | {each:.2f} | {faster} | {one.memory_mb:.0f} MB |")
    return "\n".join(lines)
