"""A run over a fleet: which recordings are new, who identifies them, and what is written."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

from .. import __version__
from .dataset import FORMAT, Dataset, described, files_for, place, rows_of
from .engines import Engine
from .engines import engine as engine_of
from .fleet import Fleet
from .progress import Count
from .settings import MEGABYTE, Settings
from .sources import Recording, Where, recordings
from .work import Identifying, Outcome, Task


def run(
    where: Where,
    out: str | os.PathLike[str],
    *,
    names: str | None = None,
    engine: str | Engine[Task, Outcome] = "local",
    workers: int | None = None,
    ray_address: str | None = None,
    storage: Mapping[str, Any] | None = None,
    longest_s: float = 600.0,
    largest_mb: float = 4000.0,
    read_again: bool = False,
    on_progress: Callable[[Count], None] | None = None,
    **keywords: Any,
) -> Fleet:
    """Identify every recording of a fleet and keep the results as a Parquet dataset in `out`, with a page.

    `where` is a folder, a file, a pattern with ``*`` and ``**``, an address as ``s3://bucket/runs``, several of
    these, or a DataFrame with the column `uri` and, where known, `machine`, `joint`, `time`, `age_h`, `temperature_c`.
    `names` reads these out of addresses (see `recordings`). Every other keyword is one of `identify`, as
    ``model="stribeck"``; all joints of a recording are identified unless `joint` names some.

    `engine` is ``"local"``, a process a core, ``"ray"``, a Ray cluster, or one of your own (see `engines.Engine`); the
    results are the same to the last bit.
    What was identified before in the same way is not done again: by size and time of change without reading it,
    with `read_again` by its content. A run that was stopped goes on so. A recording that cannot be used has a row
    that says why, and stops nothing.
    """
    settings = Settings(keywords, dict(storage or {}), float(longest_s), int(largest_mb * MEGABYTE))
    found = recordings(where, names=names, storage=settings.storage)
    dataset = Dataset(out, dict(settings.storage))
    with dataset.alone():
        run = _Run(dataset, settings, found, read_again)
        count = Count(len(found), "recording")
        work = engine_of(engine, Identifying(settings), workers, ray_address) if isinstance(engine, str) else engine
        outcomes = work.outcomes(run.tasks(count))
        try:
            for outcome in outcomes:
                run.take(outcome, count)
                if on_progress is not None:
                    on_progress(count)
        finally:
            outcomes.close()
        run.finish()
        fleet = Fleet(dataset)
        fleet.write_page()
    return fleet


class _Open(NamedTuple):
    """A file of the dataset that is not complete."""

    rows: list[dict[str, Any]]
    waits: set[str]


class _Run:
    """What is known, what is asked, and what came."""

    def __init__(self, dataset: Dataset, settings: Settings, found: list[Recording], read_again: bool) -> None:
        self._dataset, self._settings, self._read_again = dataset, settings, read_again
        about = dataset.about()
        self._before = int(about.get("files", 0))
        self._files = files_for(len(found))
        self._by_file: dict[int, list[Recording]] = {}
        for one in found:
            self._by_file.setdefault(place(one.uri, self._files), []).append(one)
        self._asked: dict[str, tuple[Recording, list[dict[str, Any]]]] = {}
        self._open: dict[int, _Open] = {}
        self._tell(complete=False)

    def _tell(self, *, complete: bool) -> None:
        # Until a run is complete, the files of the run before count.
        files = self._files if complete or not self._before else self._before
        about = {
            "format": FORMAT,
            "format_version": 1,
            "program_version": __version__,
            "files": files,
            "complete": complete,
            "recordings": sum(map(len, self._by_file.values())),
            "keywords": {name: str(value) for name, value in self._settings.keywords.items()},
            "settings": self._settings.key,
        }
        self._dataset.write("fleet.json", json.dumps(about, indent=2) + "\n")

    def tasks(self, count: Count) -> Iterator[Task]:
        """What is to be identified, file by file."""
        for number in sorted(self._by_file):
            known = self._known(number)
            opened = _Open([], set())
            self._open[number] = opened
            asked = []
            for one in self._by_file[number]:
                rows = known.pop(one.uri, [])
                same = bool(rows) and one.stamp != "" and rows[0]["stamp"] == one.stamp
                if same and not self._read_again:
                    opened.rows.extend(described(row, one) for row in rows)
                    count.kept += 1
                    continue
                opened.waits.add(one.uri)
                self._asked[one.uri] = (one, rows)
                asked.append(Task(one, rows[0]["hash"] if rows else None))
            self._close(number)
            yield from asked

    def _known(self, number: int) -> dict[str, list[dict[str, Any]]]:
        """What was identified before in the same way, by address."""
        rows = self._dataset.table(number, self._files).to_pylist()
        if self._before and self._before != self._files:
            rows += self._from_other_files(number)
        known: dict[str, list[dict[str, Any]]] = {}
        for row in rows:
            # What could not be read is tried again, and so is what was a copy: its original may be gone.
            if row["settings"] == self._settings.key and row["hash"] and not row["same_as"]:
                known.setdefault(row["uri"], []).append(row)
        return known

    def _from_other_files(self, number: int) -> list[dict[str, Any]]:
        """Rows of a file that lay in others, when the dataset had more or fewer of them."""
        first, last = number * self._before // self._files, ((number + 1) * self._before - 1) // self._files
        rows = []
        for other in range(first, last + 1):
            rows += self._dataset.table(other, self._before).to_pylist()
        there = {row["uri"] for row in self._dataset.table(number, self._files, ["uri"]).to_pylist()}
        return [row for row in rows if row["uri"] not in there and place(row["uri"], self._files) == number]

    def take(self, outcome: Outcome, count: Count) -> None:
        """Keeps what came of a recording; a file that is complete is written."""
        recording, before = self._asked.pop(outcome.uri)
        number = place(outcome.uri, self._files)
        opened = self._open[number]
        opened.waits.remove(outcome.uri)
        rows = before if outcome.unchanged else rows_of(recording, outcome, self._settings.key)
        opened.rows.extend(described(row, recording) for row in rows)
        count.done += 1
        count.failed += outcome.error is not None
        self._close(number)

    def _close(self, number: int) -> None:
        if not self._open[number].waits:
            self._dataset.put(number, self._files, self._open.pop(number).rows)

    def finish(self) -> None:
        """Names recordings of the same content, and drops what is no longer there."""
        first: dict[str, str] = {}
        seen: list[tuple[str, str]] = []
        for number in self._by_file:
            table = self._dataset.table(number, self._files, ["uri", "hash"])
            seen += {(row["uri"], row["hash"]) for row in table.to_pylist() if row["hash"]}
        for uri, digest in sorted(seen):
            first.setdefault(digest, uri)
        copies = {uri: first[digest] for uri, digest in seen if first[digest] != uri}
        for number in {place(uri, self._files) for uri in copies}:
            rows = self._dataset.table(number, self._files).to_pylist()
            kept = [row for row in rows if row["uri"] not in copies]
            marked = {row["uri"]: _copy(row, copies[row["uri"]]) for row in rows if row["uri"] in copies}
            self._dataset.put(number, self._files, kept + list(marked.values()))
        for number in set(range(self._files)) - set(self._by_file):
            self._dataset.drop(number, self._files)
        self._tell(complete=True)
        if self._before and self._before != self._files:
            for number in range(self._before):
                self._dataset.drop(number, self._before)


def _copy(row: dict[str, Any], original: str) -> dict[str, Any]:
    """The one row of a recording that is another's copy."""
    kept = ("uri", "machine", "time", "age_h", "temperature_c", "hash", "bytes", "stamp", "settings", "program")
    return {name: row[name] for name in kept} | {"same_as": original, "error": f"it is the same, byte for byte, as {original}"}
