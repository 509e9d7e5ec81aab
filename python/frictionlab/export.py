"""Identified friction for simulators, robots and firmware."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _native
from ._given import options
from .errors import BadInput


@dataclass(frozen=True)
class Exported:
    """A file for a target, and what the conversion costs."""

    # The file.
    text: str
    target: str
    version: str
    # What the target cannot hold of the identified friction.
    lost: tuple[str, ...]
    # Root mean square errors [% of the Coulomb level] in steady sliding, and along swings with reversals.
    sliding_error: float
    swings_error: float

    def save(self, file: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Write the file; one that is there is replaced with `force` alone."""
        path = Path(file)
        try:
            with path.open("w" if force else "x", encoding="utf-8") as out:
                out.write(self.text)
        except FileExistsError:
            raise BadInput(f"{path} is there already; force=True replaces it") from None
        except OSError as error:
            raise BadInput(f"{path} cannot be written: {error.strerror}") from None
        return path

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        errors = f"{self.sliding_error:.2f} % sliding, {self.swings_error:.2f} % along swings"
        return f"<Exported for {self.target} {self.version}: {errors}>"


def exported(parameters: str, name: str, target: str, version: str | None, given: dict[str, Any]) -> Exported:
    """What the command writes of a parameter file's text."""
    for held in ("list", "out", "force", "quiet"):
        if held in given:
            raise BadInput(f"{held} is an option of the command alone; .save(file) writes the file")
    words = options({"to": target, "target_version": version} | given)
    text, to, of, lost, sliding, swings = _native.export(words, name, parameters)
    return Exported(text, to, of, tuple(lost), sliding, swings)
