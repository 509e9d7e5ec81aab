"""Figures of matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .identification import Identification
    from .simulation import Simulation


def _figure(columns: int) -> tuple[Figure, list[object]]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.0 * columns, 3.6), layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False)[0]
    return figure, list(axes)


def simulation(found: Simulation) -> Figure:
    """Friction over time and over velocity."""
    from matplotlib.axes import Axes

    figure, axes = _figure(2)
    rotary = "torque_Nm" in found.columns
    unit, per = ("N m", "rad/s") if rotary else ("N", "m/s")
    for place, x, label in ((0, found.time, "time [s]"), (1, found.velocity, f"velocity [{per}]")):
        axis = axes[place]
        assert isinstance(axis, Axes)
        axis.plot(x, found.friction, linewidth=1.0)
        axis.set_xlabel(label)
        axis.set_ylabel(f"friction [{unit}]")
    figure.suptitle(found.model.title)
    return figure


def identification(found: Identification) -> Figure:
    """Friction curves on steady points; or an axis's force as measured and as fitted."""
    from matplotlib.axes import Axes

    figure, axes = _figure(1)
    axis = axes[0]
    assert isinstance(axis, Axes)
    unit, per = ("N m", "rad/s") if found.document["axis"] == "rotary" else ("N", "m/s")
    if found.kind == "axis":
        measured, fitted = found._predicted()
        axis.plot(measured, label="measured", linewidth=1.0)
        axis.plot(fitted, label="fitted", linewidth=1.0)
        axis.set_xlabel("sample")
        axis.set_ylabel(f"force [{unit}]")
        axis.legend()
        return figure
    velocity, friction = found._points()
    top = float(np.max(np.abs(velocity))) if len(velocity) else 1.0
    v = np.linspace(-top, top, 801)
    v = v[v != 0.0]
    for name in found.models:
        axis.plot(v, found.model(name).steady_state(v), label=name, linewidth=1.0)
    if len(velocity):
        axis.plot(velocity, friction, ".", color="black", label="measured")
    axis.set_xlabel(f"velocity [{per}]")
    axis.set_ylabel(f"friction [{unit}]")
    axis.legend()
    return figure
