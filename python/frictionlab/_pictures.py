"""Figures of matplotlib, which a notebook shows whatever its backend is."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .identification import Identification
    from .simulation import Simulation


class Picture(Figure):
    """A figure that shows itself in a notebook and opens no window."""

    def _repr_png_(self) -> bytes:
        png = BytesIO()
        self.savefig(png, format="png", dpi=110)
        return png.getvalue()


def _picture(columns: int) -> tuple[Picture, list[Axes]]:
    picture = Picture(figsize=(5.0 * columns, 3.6), layout="constrained")
    axes: list[Axes] = [picture.add_subplot(1, columns, place + 1) for place in range(columns)]
    return picture, axes


def simulation(found: Simulation) -> Figure:
    """Friction over time and over velocity."""
    picture, axes = _picture(2)
    unit, per = ("N m", "rad/s") if "torque_Nm" in found.columns else ("N", "m/s")
    over = ((found.time, "time [s]"), (found.velocity, f"velocity [{per}]"))
    for axis, (x, label) in zip(axes, over, strict=True):
        axis.plot(x, found.friction, linewidth=1.0)
        axis.set_xlabel(label)
        axis.set_ylabel(f"friction [{unit}]")
    picture.suptitle(found.model.title)
    return picture


def identification(found: Identification) -> Figure:
    """Friction curves on steady points; or an axis's force as measured and as fitted."""
    picture, (axis,) = _picture(1)
    unit, per = ("N m", "rad/s") if found.document["axis"] == "rotary" else ("N", "m/s")
    if found.kind == "axis":
        measured, fitted = found._predicted()
        axis.plot(measured, label="measured", linewidth=1.0)
        axis.plot(fitted, label="fitted", linewidth=1.0)
        axis.set_xlabel("sample")
        axis.set_ylabel(f"force [{unit}]")
        axis.legend()
        return picture
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
    return picture
