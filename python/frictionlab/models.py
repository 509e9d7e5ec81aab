"""Friction models: which there are, their parameters with units, their friction over time."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any, overload

import numpy as np
import numpy.typing as npt

from . import _native
from ._given import Floats, numbers
from .errors import BadInput

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Parameter:
    """What a parameter is."""

    name: str
    meaning: str
    unit_rotary: str
    unit_linear: str
    range: str


@dataclass(frozen=True)
class ModelInfo:
    """What a model is called, and its parameters."""

    name: str
    title: str
    parameters: tuple[Parameter, ...]


def models() -> list[ModelInfo]:
    """All friction models.

    >>> [model.name for model in models()][:3]
    ['coulomb', 'viscous', 'coulomb_viscous']
    """
    return [_info(tree) for tree in json.loads(_native.catalogue(None, "test-bed"))["models"]]


def _info(tree: Mapping[str, Any]) -> ModelInfo:
    keys = ("name", "meaning", "unit_rotary", "unit_linear", "range")
    rows = (Parameter(**{key: row[key] for key in keys}) for row in tree["parameters"])
    return ModelInfo(tree["name"], tree["title"], tuple(rows))


class Model:
    """A friction model with its parameters.

    Parameters that are not given are those of the thesis's test bed (``preset="test-bed"``, N m and
    rad) or of its chapter 3 (``"chapter-3"``, N and m).

    >>> lugre = Model("lugre", f_s=0.12, f_c=0.1)
    >>> lugre["f_s"]
    0.12
    >>> lugre.steady_state([-1.0, 1.0]).shape
    (2,)
    """

    def __init__(self, name: str, preset: str = "test-bed", **parameters: Any) -> None:
        native = _native.Model.preset(name, preset)
        if parameters:
            values = json.loads(native.json())[native.name]
            for key, value in parameters.items():
                values[key] = _plain(f"{native.name}.{key}", value, values.get(key))
            native = _native.Model.read(json.dumps({native.name: values}), None)
        self._native = native

    @classmethod
    def _of(cls, native: _native.Model) -> Model:
        made = cls.__new__(cls)
        made._native = native
        return made

    @classmethod
    def from_yaml(cls, text: str, name: str | None = None) -> Model:
        """The model of a parameter file's text: what the command writes and reads."""
        return cls._of(_native.Model.read(text, name))

    @property
    def name(self) -> str:
        """As files name it."""
        return self._native.name

    @property
    def title(self) -> str:
        """As headings name it."""
        return self._native.title

    @property
    def info(self) -> ModelInfo:
        """What its parameters mean, with units and ranges."""
        return _info(json.loads(_native.catalogue(self.name, "test-bed"))["models"][0])

    @property
    def parameters(self) -> dict[str, Any]:
        """Its parameters; of an asymmetric contact `forward` and `backward`."""
        tree: dict[str, Any] = json.loads(self._native.json())
        tree = tree.get("asymmetric", tree)
        inner: dict[str, Any] = tree[self.name]
        return inner

    def __getitem__(self, name: str) -> Any:
        return self.parameters[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.parameters)

    @overload
    def steady_state(self, velocity: float) -> float: ...
    @overload
    def steady_state(self, velocity: npt.ArrayLike) -> Floats: ...
    def steady_state(self, velocity: npt.ArrayLike) -> Floats | float:
        """The friction at each velocity once everything has settled."""
        array = numbers(velocity, "velocity", (0, 1))
        forces = self._native.steady_state(array.reshape(-1))
        return forces if array.ndim else float(forces[0])

    def force(self, velocity: npt.ArrayLike, dt: float, *, scheme: str = "mean") -> Floats:
        """The friction along velocities that are `dt` [s] apart, from rest.

        >>> Model("coulomb", f_c=0.1).force([0.5, -0.5], 1e-3).round(3).tolist()
        [0.1, -0.1]
        """
        return self._native.force(numbers(velocity, "velocity"), dt, scheme)

    def sweep(
        self,
        varied: Mapping[str, npt.ArrayLike],
        velocity: npt.ArrayLike,
        dt: float,
        *,
        scheme: str = "mean",
        jobs: int | None = None,
    ) -> Floats:
        """The friction of many parameter sets along one motion, a row a set, on all cores.

        LuGre, GMS, Xiong's and the proposed model compute sixteen sets at once on each core, to rounding what
        `force` gives.

        `varied` has a value a set for each parameter that varies; a number of a list is named by its
        place, as ``"kappa[0]"``. The others are this model's.

        >>> Model("coulomb").sweep({"f_c": [0.1, 0.2]}, [0.5, -0.5], 1e-3).round(3).tolist()
        [[0.1, -0.1], [0.2, -0.2]]
        """
        columns = [(name, numbers(values, name)) for name, values in varied.items()]
        return self._native.sweep(columns, numbers(velocity, "velocity"), dt, scheme, jobs)

    def contact(self, dt: float, *, scheme: str = "held") -> _native.Contact:
        """The model at rest, whose `step(velocity)` gives the friction once every `dt` [s]."""
        return self._native.contact(dt, scheme)

    def to_yaml(self) -> str:
        """A parameter file, as `frictionlab simulate` and `from_yaml` read it."""
        return json.dumps(json.loads(self._native.json()), indent=2) + "\n"

    def to_pandas(self) -> pd.DataFrame:
        """Value, unit, range and meaning of each parameter."""
        import pandas as pd

        values = self.parameters
        rows = [
            {"parameter": row.name, "value": values.get(row.name), "unit": row.unit_rotary, "range": row.range,
             "meaning": row.meaning}
            for row in self.info.parameters
        ]  # fmt: skip
        return pd.DataFrame(rows).set_index("parameter")

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return f"Model({self.name!r}, {values})"

    def _repr_html_(self) -> str:
        return f"<b>{escape(self.title)}</b>{self.to_pandas().to_html()}"


def _plain(name: str, value: Any, before: Any) -> Any:
    """A number or a list of numbers, as JSON has them."""
    if value is None:
        return None
    array = numbers(value, name, (1,) if isinstance(before, list) else (0,))
    if not np.isfinite(array).all():
        raise BadInput(f"{name} must be a finite number, but is {value}")
    return value.tolist() if hasattr(value, "tolist") else value
