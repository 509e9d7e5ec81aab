"""`compare` tells whether two identifications differ."""

from __future__ import annotations

import json
import os
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from . import _native
from ._given import path
from .errors import BadInput
from .identification import Identification, _seed

if TYPE_CHECKING:
    import pandas as pd

# What was identified, its identification.json, or the folder that holds it.
Report: TypeAlias = "Identification | str | os.PathLike[str]"


class Comparison:
    """What two identifications say of one model."""

    def __init__(self, document: str, text: str) -> None:
        # All that was compared: `parameters` and `torque`, each difference with its 95 % interval.
        self.document: dict[str, Any] = json.loads(document)
        self._text = text

    @property
    def differ(self) -> bool:
        """Whether anything differs by more than chance explains, in 5 % of the cases wrongly."""
        return bool(self.document["differ"])

    @property
    def answer(self) -> str:
        """The plain answer."""
        return self._text.split("\n", 1)[0]

    @property
    def parameters(self) -> pd.DataFrame:
        """A row a parameter of both."""
        import pandas as pd

        return pd.DataFrame(self.document["parameters"]).set_index("name")

    @property
    def torque(self) -> pd.DataFrame:
        """A row a velocity: the friction of both in steady sliding."""
        import pandas as pd

        return pd.DataFrame(self.document["torque"]).set_index("velocity")

    def __bool__(self) -> bool:
        return self.differ

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<Comparison: {self.answer}>"

    def _repr_html_(self) -> str:
        return f"<p><b>{escape(self.answer)}</b></p>{self.parameters.to_html()}"


def compare(
    first: Report, second: Report, model: str | None = None, *, speeds: tuple[float, float] | None = None, seed: int = 1
) -> Comparison:
    """Tell whether two identifications differ: parameter by parameter, and as friction over the speeds of both.

    Each is what `identify` gave, or the `identification.json` that was written, or its folder. `speeds` [rad/s or
    m/s] are those of both if none are given. Of axes the symmetric models are compared.
    """
    ends = None if speeds is None else [float(speeds[0]), float(speeds[1])]
    return Comparison(*_native.compare(_read(first, "first"), _read(second, "second"), model, ends, _seed(seed)))


def _read(report: Report, which: str) -> tuple[str, str]:
    if isinstance(report, Identification):
        return f"the {which}", report._found.json()
    file = Path(path(report))
    file = file / "identification.json" if file.is_dir() else file
    try:
        return str(report), file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{report}: {error}") from None
