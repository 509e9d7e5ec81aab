"""`identify` and what it finds."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

from . import _native
from ._given import Data, Floats, inputs, options
from .errors import BadInput
from .export import Exported, exported
from .models import Model

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Estimate:
    """A parameter that was estimated."""

    value: float
    unit: str
    standard_error: float | None
    # Low and high end, with 95 % between them.
    interval_95: tuple[float, float] | None
    # Whether the recordings tell it, and in words what they tell.
    identified: bool
    verdict: str

    def __float__(self) -> float:
        return self.value


@dataclass(frozen=True)
class Fit:
    """A model that was identified."""

    name: str
    parameters: dict[str, Estimate]
    # Root mean square of what it leaves [N m or N] or relative error [%], see `error_unit`.
    error: float
    # The same on recordings that it was not fitted to.
    held_out: float | None
    error_unit: str
    notes: tuple[str, ...]

    def __getitem__(self, name: str) -> Estimate:
        return self.parameters[name]


class Identification:
    """What was found: models with values, standard errors, intervals and verdicts."""

    def __init__(self, found: _native.Found) -> None:
        self._found = found
        # All that was found, as `identification.json` has it.
        self.document: dict[str, Any] = json.loads(found.json())

    @property
    def kind(self) -> str:
        """`friction` for friction models, `axis` for inertia and friction of a driven axis."""
        return self._found.kind

    @cached_property
    def models(self) -> dict[str, Fit]:
        """The models by name, best first where they were compared."""
        if self.kind == "axis":
            named = {name: self.document[name] for name in ("symmetric", "asymmetric")}
            return {name: _axis_fit(name, tree) for name, tree in named.items() if tree is not None}
        unit = "N m" if self.document["axis"] == "rotary" else "N"
        return {name: _friction_fit(name, tree, unit) for name, tree in self.document["models"].items()}

    @property
    def chosen(self) -> str | None:
        """The model to use; none where no fit can be trusted, or where none was to be chosen."""
        name: str | None = self.document.get("ranking", {}).get("chosen")
        return name

    @property
    def best(self) -> Fit:
        """The chosen model; where none is, the first."""
        return self.models[self.chosen] if self.chosen else next(iter(self.models.values()))

    @property
    def warnings(self) -> list[str]:
        """Why it is not to be trusted as a whole."""
        return list(self.document["warnings"])

    @property
    def notes(self) -> list[str]:
        """What must be known to read the numbers right."""
        return list(self.document["notes"])

    def __getitem__(self, name: str) -> Fit:
        if name not in self.models:
            raise KeyError(f"{name}; identified were {', '.join(self.models)}")
        return self.models[name]

    def model(self, name: str | None = None) -> Model:
        """A model with the values that were found, to be simulated; the chosen one if none is named."""
        name = name or self.chosen
        if name is None and self.kind == "friction":
            raise BadInput("no model is chosen here, because no fit can be trusted; name one, as in model('lugre')")
        return Model._of(self._found.model(name or ""))

    def to_pandas(self) -> pd.DataFrame:
        """A row a parameter of each model."""
        import pandas as pd

        rows = [
            {
                "model": fit.name,
                "parameter": name,
                "value": estimate.value,
                "standard_error": estimate.standard_error,
                "low_95": estimate.interval_95[0] if estimate.interval_95 else None,
                "high_95": estimate.interval_95[1] if estimate.interval_95 else None,
                "unit": estimate.unit,
                "identified": estimate.identified,
                "verdict": estimate.verdict,
            }
            for fit in self.models.values()
            for name, estimate in fit.parameters.items()
        ]
        return pd.DataFrame(rows).set_index(["model", "parameter"])

    def to_yaml(self) -> str:
        """`parameters.yaml`, as `run`, `live` and the nodes read it."""
        return self._found.yaml()

    def to_html(self) -> str:
        """The whole report, `report.html`."""
        return self._found.html()

    def save(self, folder: str | os.PathLike[str], *, force: bool = False) -> str:
        """Write report, document and parameters into a folder, as the command does."""
        return self._found.save(os.fspath(folder), force)

    def export(self, target: str, version: str | None = None, **keywords: Any) -> Exported:
        """The friction for a simulator, a robot or firmware, as `frictionlab export` writes it.

        `target` is one of those that `frictionlab export --list` shows, as ``"mjcf"``, ``"urdf"`` or
        ``"c_header"``; `version` its newest if none is given. Every other option of the command is a
        keyword: ``joint="elbow"``, ``model="lugre"``, ``armature=1e-3``, ``accept_error=True``. What would
        mislead is refused.
        """
        return exported(self.to_yaml(), "parameters.yaml", target, version, keywords)

    def plot(self) -> Figure:
        """The friction curves on the steady points, or the axis's force as measured and as fitted."""
        from ._pictures import identification

        return identification(self)

    def _points(self) -> list[Floats]:
        return self._found.points()

    def _predicted(self) -> list[Floats]:
        return self._found.predicted()

    def __str__(self) -> str:
        return self._found.text()

    def __repr__(self) -> str:
        chosen = f", chosen {self.chosen}" if self.chosen else ""
        return f"<Identification ({self.kind}): {', '.join(self.models)}{chosen}>"

    def _repr_html_(self) -> str:
        said = "".join(f"<p><b>{escape(text)}</b></p>" for text in self.warnings)
        return said + str(self.to_pandas().to_html())


def _interval(ends: Any) -> tuple[float, float] | None:
    return None if ends is None else (ends[0], ends[1])


def _friction_fit(name: str, tree: Mapping[str, Any], unit: str) -> Fit:
    parameters = {
        key: Estimate(
            row["value"],
            row["unit"],
            row["standard_error"],
            _interval(row["interval_95"]),
            row["identified"],
            row["explanation"] or "",
        )
        for key, row in tree["parameters"].items()
    }
    held_out = tree["held_out"]["rms"] if tree["held_out"] else None
    return Fit(name, parameters, tree["fit"]["rms"], held_out, unit, tuple(tree["notes"]))


def _axis_fit(name: str, tree: Mapping[str, Any]) -> Fit:
    def estimate(row: Mapping[str, Any]) -> Estimate:
        value, half = row["value"], row["half_width_95"]
        ends = None if half is None or value is None else (value - half, value + half)
        verdict = row["not_to_be_trusted"] or ("" if row["identifiable"] else "not identified")
        return Estimate(value, row["unit"], row["standard_error"], ends, row["identifiable"], verdict)

    parameters = {key: estimate(row) for key, row in tree["parameters"].items()}
    other = tree["cross_test"]
    held_out = other["relative_error_percent"] if other else None
    return Fit(name, parameters, tree["relative_error_percent"], held_out, "%", ())


def identify(
    data: Data | Iterable[Data],
    *,
    model: str | Iterable[str] | None = None,
    validate: Data | Iterable[Data] = (),
    **keywords: Any,
) -> Identification:
    """Find friction and inertia in recordings, as `frictionlab identify` does, with the same result.

    `data` is a file (CSV, .mat, .npz, .parquet) or a bag, a DataFrame, arrays by name (as `t_s`,
    `position_rad`, `torque_Nm`; steady points as `velocity_rad_s`, `torque_Nm`), or several of these.
    `validate` is data that no fit sees. Every other option of the command is a keyword:
    ``inertia="0.0026:0.00003"``, ``torque_source="driving"``, ``structure="auto"``, ``axis="rotary"``.
    Rows without a number (NaN) are left out and counted, as those of a file are.

    >>> import numpy as np
    >>> v = np.linspace(0.05, 3.0, 40)
    >>> points = {"velocity_rad_s": np.r_[-v, v], "torque_Nm": np.r_[-0.1 - 0.04 * v, 0.1 + 0.04 * v]}
    >>> found = identify(points, model="coulomb_viscous")
    >>> round(found["coulomb_viscous"]["f_c"].value, 6)
    0.1
    """
    for held in ("out", "force", "quiet", "json", "verbose", "thesis_tables"):
        if held in keywords:
            raise BadInput(f"{held} is an option of the command alone; .save(folder) writes the files")
    names, tables = inputs(data, "data")
    others, more = inputs(validate, "validate")
    line = options(keywords | {"model": model})
    line += [f"--validate={name}" for name in others]
    return Identification(_native.identify(line, names, tables + more))
