"""Which recordings there are: in folders, by patterns, in tables of addresses, here or in a store."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from ..errors import BadInput
from .needs import needed

if TYPE_CHECKING:
    import pandas as pd

# What a folder is searched for.
ENDINGS = (".csv", ".parquet", ".npz", ".mat", ".h5", ".hdf5", ".mcap", ".db3", ".tsv")
# What a name or a table may tell of a recording besides its address.
NAMED = ("machine", "joint", "time", "age_h", "temperature_c")

# A folder, a file, a pattern or an address; several; or a DataFrame with the column `uri`.
Where: TypeAlias = "str | os.PathLike[str] | pd.DataFrame | Iterable[str | os.PathLike[str]]"


class Recording(NamedTuple):
    """A recording before it is read."""

    # A path, or an address as s3://bucket/run.csv; of a bag the folder.
    uri: str
    # Changes with the content: size, and time of change or the store's tag. Empty where nobody told it.
    stamp: str = ""
    machine: str | None = None
    joint: str | None = None
    # Seconds since 1970.
    time: float | None = None
    # Hours that the machine has run.
    age_h: float | None = None
    temperature_c: float | None = None


def recordings(where: Where, *, names: str | None = None, storage: Mapping[str, Any] | None = None) -> list[Recording]:
    """All recordings, in the order of their addresses, each once.

    `names` is a regular expression that is searched in each address. Its named groups `machine`, `joint`, `time`
    (ISO 8601 or seconds since 1970), `age_h` and `temperature_c` say what the recording is of.

    >>> import pathlib, tempfile
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> for name in ("arm7_2026-01-02.csv", "arm7_2026-01-03.csv", "notes.txt"):
    ...     _ = (folder / name).write_text("t_s")
    >>> found = recordings(folder, names=r"(?P<machine>arm[0-9]+)_(?P<time>[0-9-]+)")
    >>> [(one.machine, one.time) for one in found]
    [('arm7', 1767312000.0), ('arm7', 1767398400.0)]
    """
    pattern = _pattern(names)
    found: dict[str, Recording] = {}
    for one in _all(where, dict(storage or {})):
        if one.uri not in found:
            found[one.uri] = one if pattern is None else _named(one, pattern)
    if not found:
        raise BadInput(f"there is no recording in {_shown(where)}; expected {', '.join(ENDINGS)} or bags")
    return [found[uri] for uri in sorted(found)]


def opened(uri: str, storage: Mapping[str, Any]) -> tuple[Any, str]:
    """The file system of an address, and the path in it."""
    needed("fsspec", "fleet")
    from fsspec.core import url_to_fs

    options = dict(storage) if "://" in uri and not uri.startswith("file://") else {}
    try:
        found: tuple[Any, str] = url_to_fs(uri, **options)
    except ImportError as error:
        raise BadInput(f"{uri}: {error}; `pip install 'frictionlab[s3]'` installs what S3 needs") from None
    except (ValueError, TypeError) as error:
        raise BadInput(f"{uri}: {error}") from None
    return found


def _all(where: Where, storage: dict[str, Any]) -> Iterator[Recording]:
    if hasattr(where, "columns"):
        yield from _table(where)
        return
    places = [where] if isinstance(where, str | os.PathLike) else where
    for place in places:
        yield from _place(os.fspath(place), storage)


def _place(place: str, storage: dict[str, Any]) -> Iterator[Recording]:
    """The recordings of a folder, a pattern or a file."""
    files, path = opened(place, storage)
    try:
        if any(sign in path for sign in "*?["):
            listed = dict(files.glob(path, detail=True))
            for folder in [name for name, info in listed.items() if info["type"] == "directory"]:
                listed.update(files.find(folder, detail=True))
            chosen = {name: info for name, info in listed.items() if info["type"] != "directory"}
        else:
            info = files.info(path)
            if info["type"] != "directory":
                yield Recording(_address(files, path), _stamp([info]))
                return
            chosen = {
                name: one for name, one in files.find(path, detail=True).items() if name.endswith((*ENDINGS, "/metadata.yaml"))
            }
    except FileNotFoundError:
        raise BadInput(f"{place}: there is no such file or folder") from None
    except Exception as error:  # each store raises its own
        raise BadInput(f"{place}: cannot be listed: {error}") from None
    yield from _of_files(files, chosen)


def _of_files(files: Any, chosen: Mapping[str, Any]) -> Iterator[Recording]:
    """A bag is the folder with its metadata.yaml; everything else is a file."""
    bags: dict[str, list[Any]] = {name.rpartition("/")[0]: [] for name in chosen if name.endswith("/metadata.yaml")}
    for name in sorted(chosen):
        folder = name.rpartition("/")[0]
        if folder in bags:
            bags[folder].append(chosen[name])
        elif name.endswith(ENDINGS):
            yield Recording(_address(files, name), _stamp([chosen[name]]))
    for folder, infos in bags.items():
        yield Recording(_address(files, folder), _stamp(infos))


def _address(files: Any, path: str) -> str:
    """Paths of this machine are shown as paths."""
    protocol = files.protocol if isinstance(files.protocol, str) else files.protocol[0]
    return str(Path(path)) if protocol in ("file", "local") else str(files.unstrip_protocol(path))


def _stamp(infos: Iterable[Mapping[str, Any]]) -> str:
    def one(info: Mapping[str, Any]) -> str:
        changed = next((info[key] for key in ("ETag", "etag", "md5Hash", "mtime", "LastModified") if info.get(key)), "")
        return f"{info.get('size')}:{str(changed).strip(chr(34))}" if changed else ""

    return "+".join(one(info) for info in infos)


def _table(table: Any) -> Iterator[Recording]:
    """A row a recording; other columns than those that are known are left alone."""
    if "uri" not in table.columns:
        raise BadInput(f"a table of recordings needs the column `uri`, but has {', '.join(map(str, table.columns))}")
    known = [name for name in ("stamp", *NAMED) if name in table.columns]
    for values in table[["uri", *known]].itertuples(index=False):
        row = dict(zip(["uri", *known], values, strict=True))
        uri = row.pop("uri")
        if not isinstance(uri, str) or not uri:
            raise BadInput(f"a table of recordings has {uri!r} in the column `uri`, where an address was expected")
        local = "://" not in uri
        told = {name: _told(name, value, uri) for name, value in row.items() if not _missing(value)}
        stamp = told.pop("stamp", None) or (_of_file(Path(uri)) if local else "")
        yield Recording(str(Path(uri).absolute()) if local else uri, stamp, **told)


def _of_file(path: Path) -> str:
    try:
        state = path.stat()
    except OSError:
        return ""
    return f"{state.st_size}:{state.st_mtime}" if path.is_file() else ""


def _missing(value: Any) -> bool:
    import pandas as pd

    # Also `pd.NA`, which is neither equal to itself nor unequal.
    return bool(pd.isna(value)) or value == ""


def _pattern(names: str | None) -> re.Pattern[str] | None:
    if names is None:
        return None
    try:
        pattern = re.compile(names)
    except re.error as error:
        raise BadInput(f"the names must be a regular expression, but {names!r} is none: {error}") from None
    unknown = set(pattern.groupindex) - set(NAMED)
    if unknown or not pattern.groupindex:
        got = ", ".join(sorted(unknown)) or "none"
        raise BadInput(f"expected named groups among {', '.join(NAMED)}, as in (?P<machine>arm[0-9]+), but got {got}")
    return pattern


def _named(one: Recording, pattern: re.Pattern[str]) -> Recording:
    found = pattern.search(one.uri)
    if found is None:
        return one
    told = {name: _told(name, text, one.uri) for name, text in found.groupdict().items() if text}
    return one._replace(**{name: value for name, value in told.items() if getattr(one, name) is None})


def _told(name: str, value: Any, uri: str) -> Any:
    """What a name or a table tells, in the type of its column."""
    if name in ("machine", "joint", "stamp"):
        return str(value)
    try:
        return _seconds(value) if name == "time" else float(value)
    except (ValueError, TypeError):
        expected = "a date and time (ISO 8601) or seconds since 1970" if name == "time" else "a number"
        raise BadInput(f"{uri}: `{name}` must be {expected}, but is {value!r}") from None


def _seconds(value: Any) -> float:
    try:
        return float(value)
    except (ValueError, TypeError):
        import pandas as pd

        at = pd.Timestamp(value)
        at = at.tz_localize("UTC") if at.tzinfo is None else at
        return float(at.timestamp())


def _shown(where: Where) -> str:
    if hasattr(where, "columns"):
        return "the table"
    places = [where] if isinstance(where, str | os.PathLike) else where
    return ", ".join(os.fspath(place) for place in places)
