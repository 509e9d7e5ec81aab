"""A model along a motion."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._given import Floats, is_table, path, table
from .models import Model

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Simulation:
    """The friction along a motion: columns by their names, as `frictionlab simulate` writes them."""

    model: Model
    columns: dict[str, Floats]
    slips: npt.NDArray[np.bool_]
    notes: tuple[str, ...]

    def __getitem__(self, name: str) -> Floats:
        return self.columns[name]

    @property
    def time(self) -> Floats:
        """When [s]."""
        return self.columns["t_s"]

    @property
    def friction(self) -> Floats:
        """The friction [N m or N]; it opposes the motion."""
        return self.columns[self._named("torque_Nm", "force_N")]

    @property
    def velocity(self) -> Floats:
        """How fast [rad/s or m/s]."""
        return self.columns[self._named("velocity_rad_s", "velocity_m_s")]

    def _named(self, rotary: str, linear: str) -> str:
        return rotary if rotary in self.columns else linear

    def to_pandas(self) -> pd.DataFrame:
        """A row a sample; `regime` says stick or slip."""
        import pandas as pd

        regime = pd.Categorical(np.where(self.slips, "slip", "stick"), categories=["stick", "slip"])
        return pd.DataFrame({**self.columns, "regime": regime}).set_index("t_s")

    def plot(self) -> Figure:
        """Friction over time and over velocity."""
        from ._pictures import simulation

        return simulation(self)

    def __repr__(self) -> str:
        return f"<Simulation of {self.model.name}: {len(self.time)} rows, {', '.join(self.columns)}>"

    def _repr_html_(self) -> str:
        return str(self.to_pandas().to_html(max_rows=10))


def simulate(
    model: Model | str,
    motion: str | os.PathLike[str] | pd.DataFrame | Mapping[str, npt.ArrayLike],
    *,
    scheme: str = "mean",
    dt: float = 1e-5,
    tolerance: float = 1e-6,
    load_gain: float | None = None,
) -> Simulation:
    """Evaluate a model along a motion, as `frictionlab simulate` does.

    The motion has a time and a velocity, as `t_s` and `velocity_rad_s`, at any spacing: a file, a
    DataFrame, or arrays by name. `dt` is the longest step [s]; `scheme` is ``mean``, ``held`` or ``rk4``.

    >>> import numpy as np
    >>> t = np.linspace(0.0, 1.0, 101)
    >>> found = simulate("lugre", {"t_s": t, "velocity_rad_s": 0.3 * np.sin(6.0 * t)}, dt=1e-3)
    >>> found.friction.shape
    (101,)
    """
    model = Model(model) if isinstance(model, str) else model
    file, given = (None, table(motion, "<motion>")) if is_table(motion) else (path(motion), None)  # type: ignore[arg-type]
    options: dict[str, Any] = {"scheme": scheme, "dt": dt, "tolerance": tolerance, "load_gain": load_gain}
    columns, slips, notes = _native.simulate(model._native, file, given, **options)
    return Simulation(model, columns, slips, tuple(notes))
