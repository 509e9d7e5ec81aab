"""A recording's content, with its hash, as a file on this machine."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from ..errors import BadInput
from .settings import MEGABYTE, Settings
from .sources import ENDINGS, opened

CHUNK = 1 << 20


class Content(NamedTuple):
    """A recording that was read once from end to end."""

    # Where it lies on this machine.
    path: Path
    # SHA-256 of the content; of a bag, of the names and contents of its files.
    hash: str
    bytes: int


@contextmanager
def content(uri: str, settings: Settings) -> Iterator[Content]:
    """The recording's content; what was fetched for it is deleted afterwards.

    Raises `BadInput` for what cannot be read or is too large, and afterwards where it changed meanwhile.
    """
    files, path = opened(uri, settings.storage)
    try:
        # A store is asked no more than needed: what is called like a file is one.
        folder = not path.endswith(ENDINGS) and files.isdir(path)
        names = sorted(files.find(path)) if folder else [path]
    except Exception as error:  # each store raises its own
        raise _unreadable(uri, error) from None
    if "://" not in uri or uri.startswith("file://"):
        for name in names:
            # A pipe would be waited for, and nobody may ever write to it.
            if Path(name).exists() and not Path(name).is_file():
                raise BadInput(f"{uri}: a file was expected, but {name} is a pipe, a device or a folder")
        before = _states(names)
        digest, size = _read(uri, files, path, names, settings, None)
        yield Content(Path(path), digest, size)
        if _states(names) != before:
            raise BadInput(f"{uri}: it changed while it was read; is it still being written?")
        return
    with tempfile.TemporaryDirectory(prefix="friction-fleet-") as name:
        place = Path(name) / (Path(path).name or "recording")
        digest, size = _read(uri, files, path, names, settings, place)
        yield Content(place, digest, size)


def _read(uri: str, files: Any, path: str, names: list[str], settings: Settings, place: Path | None) -> tuple[str, int]:
    """Hash and size; with a place, the content is put there."""
    whole, size = hashlib.sha256(), 0
    for name in names:
        inside = name[len(path) :].lstrip("/") if len(names) > 1 or name != path else ""
        part = hashlib.sha256()
        target = None
        if place is not None:
            target = place / inside if inside else place
            target.parent.mkdir(parents=True, exist_ok=True)
        try:
            with files.open(name, "rb") as source, target.open("wb") if target else _nowhere() as sink:
                while chunk := source.read(CHUNK):
                    size += len(chunk)
                    if size > settings.largest_bytes:
                        most = settings.largest_bytes / MEGABYTE
                        raise BadInput(f"{uri}: it is larger than {most:g} MB; allow more with --largest-mb")
                    part.update(chunk)
                    if sink is not None:
                        sink.write(chunk)
        except BadInput:
            raise
        except Exception as error:
            raise _unreadable(uri, error) from None
        whole.update(part.digest() if not inside else inside.encode() + b"\0" + part.digest())
    return whole.hexdigest(), size


@contextmanager
def _nowhere() -> Iterator[None]:
    yield None


def _states(names: list[str]) -> list[tuple[int, int]]:
    try:
        return [((state := Path(name).stat()).st_size, state.st_mtime_ns) for name in names]
    except OSError:
        return []


def _unreadable(uri: str, error: Exception) -> BadInput:
    if isinstance(error, FileNotFoundError):
        return BadInput(f"{uri}: there is no such recording")
    if isinstance(error, PermissionError):
        return BadInput(f"{uri}: reading it is not allowed: {error}; look at the permissions or credentials")
    return BadInput(f"{uri}: cannot be read: {type(error).__name__}: {error}")
