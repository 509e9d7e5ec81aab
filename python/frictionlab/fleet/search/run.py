"""A search over shares: which are known, who does the others, and what is joined."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ... import __version__
from ...errors import BadInput, Failure
from ..dataset import Dataset
from ..engines import Engine
from ..engines import engine as engine_of
from ..progress import Count, counted
from .share import Found, Share

FORMAT = "frictionlab-search"
# Options that the search gives itself.
OURS = ("--part", "--join", "--out", "--force", "--json", "--quiet")
SHARES = 20
MOST = 100_000
DAY = 86_400.0


class Searched(NamedTuple):
    """A search that is through."""

    # Folder with the result, as the command writes it.
    out: Path
    # What the command prints of the result.
    text: str
    # Why, of shares that came to nothing: the result is of the others.
    failed: list[str]


def search(
    command: Sequence[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    shares: int | None = None,
    engine: str | Engine[int, Found] = "local",
    workers: int | None = None,
    ray_address: str | None = None,
    longest_s: float = DAY,
    on_progress: Callable[[Count], None] | None = None,
) -> Searched:
    """Do the work of a command in shares, on all cores or on a Ray cluster, and keep its result in ``out/result``.

    `command` is ``["frictionlab", "monte-carlo", "--draws", "10000"]``, ``["frictionlab", "truth-matrix"]``,
    ``["frictionlab", "commission", "--trial", "500"]``, ``["cargo", "xtask", "strangers"]`` or any other program that
    has the options ``--part`` and ``--join``. The result is that of the command alone, bit for bit. On a cluster the
    program must be installed on each machine.

    What a share found is kept in ``out/shares``. The same call again does only what is missing. A share that fails is
    told, and the result is of the others.
    """
    line, folder = _command(command), os.fspath(out)
    if "://" in folder:
        raise BadInput(f"the result of a search goes into a folder of this machine, but {folder} is an address")
    if not 0.0 < longest_s <= 1e7:
        raise BadInput(f"the longest time for a share must be above 0 s and at most 1e7 s, but is {longest_s}")
    store = Dataset(folder)
    with store.alone():
        of = _begin(store, Path(folder), line, shares)
        work = Share(line, of, float(longest_s), str(Path.cwd()))
        does = engine_of(engine, work, workers, ray_address) if isinstance(engine, str) else engine
        failed = _shares(store, Path(folder), of, does, on_progress)
        return _joined(Path(folder), line, failed)


def _command(command: Sequence[str | os.PathLike[str]]) -> tuple[str, ...]:
    """The program by its whole path where it has one, and its options."""
    if isinstance(command, str) or not command:
        raise BadInput('expected a program and its options, as ["frictionlab", "monte-carlo"]')
    program, *options = [os.fspath(word) for word in command]
    for option in options:
        if option.split("=")[0] in OURS:
            raise BadInput(f"{option} is given by the search itself; leave it out")
    if shutil.which(program) is None:
        raise BadInput(f"there is no program {program}; give its path")
    return (str(Path(program).absolute()) if os.sep in program else program, *options)


def _begin(store: Dataset, folder: Path, line: tuple[str, ...], shares: int | None) -> int:
    """The number of shares: that of before, where the search goes on."""
    if shares is not None and not 1 <= shares <= MOST:
        raise BadInput(f"the number of shares must be from 1 to {MOST}, but is {shares}")
    about = _about(folder)
    if about is None:
        of = shares or SHARES
        told = {"format": FORMAT, "format_version": 1, "program_version": __version__, "command": list(line), "shares": of}
        store.write("search.json", json.dumps(told, indent=2) + "\n")
        return of
    if about.get("command") != list(line) or shares not in (None, about["shares"]):
        was = " ".join(map(str, about.get("command", [])))
        raise BadInput(f"{folder} holds a search of `{was}` in {about['shares']} shares; give the same or another folder")
    return int(about["shares"])


def _about(folder: Path) -> dict[str, Any] | None:
    """What the folder is of; none where it is new."""
    file = folder / "search.json"
    if not file.exists():
        if any(entry.name != ".lock" for entry in folder.iterdir()):
            raise BadInput(f"{folder} is not empty and holds no search.json; give another folder for the results")
        return None
    try:
        about = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{file} is damaged: {error}") from None
    if not isinstance(about, dict) or about.get("format") != FORMAT or not isinstance(about.get("shares"), int):
        raise BadInput(f"{file} is not of a search; give another folder for the results")
    return about


def _shares(
    store: Dataset, folder: Path, of: int, engine: Engine[int, Found], on_progress: Callable[[Count], None] | None
) -> list[str]:
    """Does what is missing; why, of what came to nothing."""
    missing = [number for number in range(1, of + 1) if not (folder / _name(number, of)).is_file()]
    count = Count(of, "share", kept=of - len(missing))
    failed = []
    outcomes = engine.outcomes(missing)
    try:
        for found in outcomes:
            count.done += 1
            if found.document is None:
                if found.refused:
                    # So it would each share.
                    raise BadInput(found.error or "the program refuses its options")
                count.failed += 1
                failed.append((found.number, found.error or "nothing was found"))
            else:
                store.write(_name(found.number, of), found.document)
            if on_progress is not None:
                on_progress(count)
    finally:
        outcomes.close()
    if len(failed) == of:
        raise Failure(f"no share came to a result; the first: {min(failed)[1]}")
    return [why for _, why in sorted(failed)]


def _name(number: int, of: int) -> str:
    return f"shares/part-{number:05d}-of-{of:05d}.json"


def _joined(folder: Path, line: tuple[str, ...], failed: list[str]) -> Searched:
    """What the command makes of all shares."""
    result = folder / "result"
    # It is made of the shares, which stay.
    shutil.rmtree(result, ignore_errors=True)
    asked = [*line, "--join", str((folder / "shares").absolute()), "--out", str(result.absolute())]
    ran = subprocess.run(asked, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    text, said = (stream.decode(errors="replace") for stream in (ran.stdout, ran.stderr))
    # That shares are missing is known: the command ends with 1 and has written its result.
    if ran.returncode == 0 or (failed and ran.returncode == 1 and text):
        return Searched(result, text, failed)
    words = said.strip() or f"{line[0]} --join ended with code {ran.returncode}"
    raise BadInput(words) if ran.returncode == 2 else Failure(words)


def told(found: Searched) -> str:
    """The sentence on shares that came to nothing; empty where all came to something."""
    if not found.failed:
        return ""
    return f"{counted(len(found.failed), 'share')} came to nothing; the same command again tries what is missing"
