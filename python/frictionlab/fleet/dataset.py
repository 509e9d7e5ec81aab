"""The dataset of results: Parquet files of a folder or a store, each written whole or not at all.

A recording's rows lie in the file that the hash of its address names. So a fleet that grows changes the files
it must, the same recordings give the same files to the last bit however they were identified, and no more than a
few files are in memory at once.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .. import __version__
from ..errors import BadInput
from .needs import needed
from .sources import Recording, opened
from .work import Outcome

# Recordings of a file, about.
EACH = 128
# Files at most.
MOST = 4096
RESULTS = "results"
FORMAT = "frictionlab-fleet"


def schema() -> Any:
    """The columns of the dataset."""
    pa = needed("pyarrow", "fleet")
    text, number, yes = pa.string(), pa.float64(), pa.bool_()
    return pa.schema(
        [
            ("uri", text),
            ("machine", text),
            ("joint", text),
            # Its name within the recording, where it has one there.
            ("joint_inside", text),
            ("time", pa.timestamp("us", "UTC")),
            ("age_h", number),
            ("temperature_c", number),
            ("model", text),
            ("chosen", yes),
            ("parameter", text),
            ("value", number),
            ("unit", text),
            ("standard_error", number),
            ("low_95", number),
            ("high_95", number),
            ("identified", yes),
            ("verdict", text),
            ("fit_error", number),
            ("fit_error_unit", text),
            ("warnings", text),
            ("error", text),
            ("same_as", text),
            ("hash", text),
            ("bytes", pa.int64()),
            ("stamp", text),
            ("settings", text),
            ("program", text),
        ]
    )


def files_for(count: int) -> int:
    """How many files a dataset of so many recordings has: a power of two."""
    files = 1
    while files * EACH < count and files < MOST:
        files *= 2
    return files


def place(uri: str, files: int) -> int:
    """The file of a recording: the first bits of the hash of its address, so that a file splits into two."""
    first = int.from_bytes(hashlib.sha256(uri.encode()).digest()[:4], "big")
    return first * files >> 32


def rows_of(recording: Recording, outcome: Outcome, settings: str) -> list[dict[str, Any]]:
    """The rows of a recording; one that says why where there is nothing else."""
    whole = {
        "uri": recording.uri,
        "hash": outcome.hash,
        "bytes": outcome.bytes,
        "settings": settings,
        "program": __version__,
    }
    rows = outcome.rows or [{"error": outcome.error or "nothing was identified"}]
    return [whole | row for row in rows]


def described(row: dict[str, Any], recording: Recording) -> dict[str, Any]:
    """The row with what is told of a recording besides its content: that may be told better the next time."""
    joint = "/".join(name for name in (recording.joint, row.get("joint_inside")) if name) or None
    time = None if recording.time is None else round(recording.time * 1e6)
    return row | {
        "machine": recording.machine,
        "joint": joint,
        "time": time,
        "age_h": recording.age_h,
        "temperature_c": recording.temperature_c,
        "stamp": recording.stamp or None,
    }


class Dataset:
    """A dataset in a folder, or in a store by its address."""

    def __init__(self, out: str | os.PathLike[str], storage: dict[str, Any] | None = None) -> None:
        self.out = os.fspath(out)
        if not self.out:
            raise BadInput("the name of the folder for the results is empty")
        self._files, self._path = opened(self.out, storage or {})
        self._local = "://" not in self.out or self.out.startswith("file://")

    def about(self) -> dict[str, Any]:
        """`fleet.json`: of what the dataset is; nothing where there is none yet."""
        text = self._get("fleet.json")
        if text is None:
            if self._get_names():
                raise BadInput(f"{self.out} is not empty and holds no fleet.json; give another folder for the results")
            return {}
        try:
            about: dict[str, Any] = json.loads(text)
        except ValueError as error:
            raise BadInput(f"{self.out}/fleet.json is damaged: {error}") from None
        if about.get("format") != FORMAT:
            raise BadInput(f"{self.out}/fleet.json is not of a fleet, but of {about.get('format')!r}; give another folder")
        return about

    def write(self, name: str, content: str | bytes) -> None:
        """Writes a file whole, or not at all."""
        bytes_ = content.encode() if isinstance(content, str) else content
        path = f"{self._path}/{name}"
        if not self._local:
            self._files.pipe_file(path, bytes_)
            return
        target = Path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        beside = target.with_name(f".{target.name}.{uuid.uuid4().hex}")
        try:
            with beside.open("wb") as file:
                file.write(bytes_)
                file.flush()
                os.fsync(file.fileno())
            beside.replace(target)
        finally:
            beside.unlink(missing_ok=True)

    def table(self, number: int, files: int, columns: list[str] | None = None) -> Any:
        """The rows of a file; none where it is not there yet."""
        content = self._get(_name(number, files))
        if content is None:
            return schema().empty_table()
        pq = needed("pyarrow.parquet", "fleet")
        try:
            return pq.read_table(io.BytesIO(content), columns=columns)
        except Exception as error:
            raise BadInput(
                f"{self.out}/{_name(number, files)} is damaged: {error}; delete it, and its recordings are identified anew"
            ) from None

    def put(self, number: int, files: int, rows: list[dict[str, Any]]) -> None:
        """Writes the rows of a file in the order that is theirs."""
        pa, pq = needed("pyarrow", "fleet"), needed("pyarrow.parquet", "fleet")
        # The rows of a recording stand together as they were found; sorting keeps their order.
        rows = sorted(rows, key=lambda row: row["uri"])
        table = pa.Table.from_pylist(rows, schema())
        sink = io.BytesIO()
        pq.write_table(table, sink, compression="zstd")
        self.write(_name(number, files), sink.getvalue())

    def drop(self, number: int, files: int) -> None:
        """Deletes a file that has no rows any longer."""
        path = f"{self._path}/{_name(number, files)}"
        if self._files.exists(path):
            self._files.rm_file(path)

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Nobody else writes to a folder of this machine meanwhile."""
        if not self._local or os.name != "posix":
            yield
            return
        import fcntl

        folder = Path(self._path)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            lock = (folder / ".lock").open("w")
        except OSError as error:
            raise BadInput(f"{self.out}: cannot be written: {error}") from None
        with lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise BadInput(f"another run writes to {self.out}; wait for it or give another folder") from None
            yield

    def _get(self, name: str) -> bytes | None:
        try:
            content: bytes = self._files.cat_file(f"{self._path}/{name}")
        except FileNotFoundError:
            return None
        except Exception as error:  # each store raises its own
            raise BadInput(f"{self.out}/{name}: cannot be read: {type(error).__name__}: {error}") from None
        return content

    def _get_names(self) -> list[str]:
        try:
            names = [str(name).rsplit("/", 1)[-1] for name in self._files.ls(self._path, detail=False)]
        except FileNotFoundError:
            return []
        except Exception as error:
            raise BadInput(f"{self.out}: cannot be listed: {type(error).__name__}: {error}") from None
        return [name for name in names if name and not name.startswith(".")]


def _name(number: int, files: int) -> str:
    return f"{RESULTS}/part-{number:04d}-of-{files:04d}.parquet"
