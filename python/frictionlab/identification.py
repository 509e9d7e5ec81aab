"""`identify` and what it finds."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

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

    def samples(self, count: int, seed: int = 1, model: str | None = None) -> pd.DataFrame:
        """Sets of parameters drawn together, as likely as the recordings leave them: a row a sample.

        They have the correlations of the fit, and 95 % of each parameter lie within its interval. Of an axis they are
        those of the symmetric model. What was not estimated is held; `.attrs["notes"]` says what, and
        `.attrs["units"]` the units.
        """
        import pandas as pd

        names, units, rows, notes = _native.samples(self._found.json(), model, _count(count), _seed(seed))
        frame = pd.DataFrame(rows, columns=names)
        frame.attrs.update(units=dict(zip(names, units, strict=True)), notes=notes)
        return frame

    def covariance(self, model: str | None = None) -> pd.DataFrame:
        """The covariance of the parameters that the last fit estimated together."""
        import pandas as pd

        fit = self.models[model] if model else self.best
        of = self.document if self.kind == "axis" else self.document.get("models", {})
        tree = of.get(fit.name, {}).get("correlation")
        if tree is None or not tree["matrix"]:
            raise BadInput("this identification holds no correlations; what is fitted to recordings has them")
        errors = np.array([_error_of(fit, name) for name in tree["names"]])
        matrix = np.array(tree["matrix"], dtype=np.float64) * np.outer(errors, errors)
        return pd.DataFrame(matrix, index=tree["names"], columns=tree["names"])

    def randomisation(
        self, target: str, count: int = 1000, seed: int = 1, *, joint: str = "joint", model: str | None = None
    ) -> str:
        """Samples as a file for a simulator: ``"mjlab"`` and ``"isaac_lab"`` are event terms, ``"csv"`` a table."""
        return _native.randomisation(self._found.json(), model, _count(count), _seed(seed), target, joint)

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


def _error_of(fit: Fit, name: str) -> float:
    """The standard error of a parameter; not a number where it has none."""
    error = fit.parameters[name].standard_error if name in fit.parameters else None
    return np.nan if error is None else error


def _count(count: int) -> int:
    if not 1 <= count <= 1_000_000:
        raise BadInput(f"the number of samples must be from 1 to 1000000, but is {count}")
    return int(count)


def _seed(seed: int) -> int:
    if not 0 <= seed < 2**64:
        raise BadInput(f"a seed must be a whole number from 0 to 2^64 - 1, but is {seed}")
    return int(seed)


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
    `validate` is data that no fit sees; it takes part in the choice of a model and of a structure.
    Every other option of the command is a keyword:
    ``inertia="0.0026:0.00003"``, ``torque_source="driving"``, ``structure="auto"``, ``axis="rotary"``.
    Rows without a number (NaN) are left out and counted, as those of a file are.

    >>> import numpy as np
    >>> v = np.linspace(0.05, 3.0, 40)
    >>> points = {"velocity_rad_s": np.r_[-v, v], "torque_Nm": np.r_[-0.1 - 0.04 * v, 0.1 + 0.04 * v]}
    >>> found = identify(points, model="coulomb_viscous")
    >>> round(found["coulomb_viscous"]["f_c"].value, 6)
    0.1
    """
    asked = _Asked(data, validate, keywords | {"model": model})
    joint = keywords.get("joint")
    if joint is None:
        return asked.identify(None)
    if len(several := asked.joints(joint)) > 1:
        raise BadInput(f"{', '.join(several)} are several joints; use identify_joints, which gives a result for each")
    return asked.identify(several[0] if several else None)


class Joints(dict[str, Identification]):
    """What was found of each joint by its name, and of those of which nothing was: why."""

    def __init__(self, found: Mapping[str, Identification], failed: Mapping[str, str]) -> None:
        super().__init__(found)
        self.failed = dict(failed)

    def to_pandas(self) -> pd.DataFrame:
        """A row a parameter of each model of each joint."""
        import pandas as pd

        return pd.concat({name: found.to_pandas() for name, found in self.items()}, names=["joint"])


def identify_joints(
    data: Data | Iterable[Data],
    joint: str | Iterable[str] = "all",
    *,
    model: str | Iterable[str] | None = None,
    validate: Data | Iterable[Data] = (),
    **keywords: Any,
) -> Joints:
    """Identify several joints of a bag or of a table's columns, each by itself: results by joint name.

    `joint` is ``"all"``, or names of joints; the rest is as in `identify`. Recordings that name no joints are one
    joint without a name. A joint that cannot be identified
    stands in `.failed` with the reason, and the others go on; where none can, the first reason is raised.

    >>> import numpy as np
    >>> v = np.linspace(0.05, 3.0, 40)
    >>> velocity, torque = np.r_[-v, v], np.r_[-0.1 - 0.04 * v, 0.1 + 0.04 * v]
    >>> points = {"velocity_rad_s": np.c_[velocity, velocity], "torque_Nm": np.c_[torque, 2 * torque]}
    >>> found = identify_joints(points, model="coulomb_viscous")
    >>> [round(one["coulomb_viscous"]["f_c"].value, 6) for one in found.values()]
    [0.1, 0.2]
    """
    asked = _Asked(data, validate, keywords | {"model": model})
    return asked.each(joint)


def each_or_whole(data: Data, keywords: Mapping[str, Any]) -> Joints:
    """All joints by name; a recording that names none, or whose joints cannot be told, is one joint without a name."""
    return _Asked(data, (), keywords).each("all", forgiving=True)


class _Asked:
    """What is asked of an identification, ready for the extension module."""

    def __init__(self, data: Data | Iterable[Data], validate: Data | Iterable[Data], keywords: Mapping[str, Any]) -> None:
        for held in ("out", "force", "quiet", "json", "verbose", "thesis_tables"):
            if held in keywords:
                raise BadInput(f"{held} is an option of the command alone; .save(folder) writes the files")
        self._names, tables = inputs(data, "data")
        others, more = inputs(validate, "validate")
        self._tables = tables + more
        self._options = options({name: value for name, value in keywords.items() if name != "joint"})
        self._options += [f"--validate={name}" for name in others]

    def joints(self, joint: str | Iterable[str]) -> list[str]:
        return _native.joints(self._options + options({"joint": joint}), self._names, self._tables)

    def identify(self, joint: str | None) -> Identification:
        return Identification(_native.identify(self._options + options({"joint": joint}), self._names, self._tables))

    def each(self, joint: str | Iterable[str], *, forgiving: bool = False) -> Joints:
        each = _native.identify_each(self._options, options({"joint": joint}), self._names, self._tables, forgiving)
        found, failed = {}, {}
        first: BadInput | None = None
        for name, outcome in each:
            if isinstance(outcome, BadInput):
                failed[name or ""] = str(outcome)
                first = first or outcome
            elif isinstance(outcome, Exception):
                raise outcome
            else:
                found[name or ""] = Identification(outcome)
        if first is not None and not found:
            raise first
        return Joints(found, failed)
