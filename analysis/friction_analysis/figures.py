"""The figures of a bag, with no ROS: Stribeck curve, tracking and error, friction against its estimate, parts of the command.

  friction-plot runs/all-1/bag                       figures beside the bag, in runs/all-1/figures
  friction-plot runs/all-1/bag --figure stribeck --average 0.1 --format pdf
  friction-plot twin/bag --namespace axis_1 --from 2 --to 4

The Stribeck curve is fit-free: means of the measured friction torque over bins of velocity. A figure whose topics were not
recorded is left out, and that is told.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction_analysis.bag import Bag, BagError, read_bag
from friction_analysis.console import command, conclude, positive
from friction_analysis.stribeck import binned, block_means
from friction_analysis.topics import topic_name

Array = npt.NDArray[np.float64]

# Modes of friction_msgs/msg/ControllerState: name and unit of what is regulated.
MODES = {0: ("velocity", "rad/s"), 1: ("position", "rad")}
BLUE, ORANGE, GREEN, RED, GREY = "#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#7f7f7f"


def stribeck_curve(bag: Bag, namespace: str = "", average: float = 0.01) -> Figure:
    """Friction torque over velocity, means and standard deviations of bins, beside the estimate where there is one.

    `average` [s]: samples are averaged over this time first, which takes noise off the velocity; it must be short against
    the motion.
    """
    measured = bag.table("joint_states", namespace)
    _need(bag, measured, ["velocity_rad_s", "torque_Nm"], topic_name("joint_states", namespace))
    figure, axes = _figure("Stribeck curve, means of bins", 1)
    ax = axes[0]
    samples = block_means(measured[["velocity_rad_s", "torque_Nm"]], average)
    draw_curve(ax, binned(samples["velocity_rad_s"], samples["torque_Nm"]), BLUE, "measured")
    if bag.has("friction_estimate", namespace):
        estimate = bag.table("friction_estimate", namespace)
        samples = block_means(estimate[["velocity_rad_s", "torque_Nm"]], average)
        points = binned(samples["velocity_rad_s"], samples["torque_Nm"])
        ax.plot(points["velocity_rad_s"], points["torque_Nm"], ".", color=ORANGE, label="estimated")
    ax.legend()
    return figure


def draw_curve(ax: Axes, points: pd.DataFrame, color: str, label: str) -> None:
    """Draws points of `binned` with their standard deviations, on a velocity axis that is logarithmic on both sides."""
    velocity = points["velocity_rad_s"].to_numpy()
    torque = points["torque_Nm"].to_numpy()
    deviation = points["deviation_Nm"].fillna(0.0).to_numpy()
    for side in (velocity < 0.0, velocity > 0.0):
        ax.fill_between(velocity[side], (torque - deviation)[side], (torque + deviation)[side], color=color, alpha=0.2, lw=0)
        ax.plot(velocity[side], torque[side], "o-", color=color, ms=3, lw=1, label=label if side.any() else None)
        label = "_"
    slowest = float(np.abs(velocity).min()) if len(velocity) else 1e-3
    # The stretch around standstill, where there are no points, is drawn short.
    ax.set_xscale("symlog", linthresh=slowest, linscale=0.5)
    ax.set_xlabel("velocity [rad/s]")
    ax.set_ylabel("friction torque [N m]")
    ax.grid(alpha=0.3)


def tracking(bag: Bag, namespace: str = "") -> Figure:
    """Reference, feedback and error over time, of velocity and of position as far as each was regulated."""
    state = bag.table("controller_state", namespace)
    modes = [mode for mode in MODES if (state["mode"] == mode).any()]
    if not modes:
        raise BagError(f"{bag.path} has no {topic_name('controller_state', namespace)} in a known mode, 0 or 1")
    figure, axes = _figure("Tracking", 2 * len(modes))
    for index, mode in enumerate(modes):
        quantity, unit = MODES[mode]
        part = state[state["mode"] == mode]
        above, below = axes[2 * index : 2 * index + 2]
        draw_signal(above, part["feedback"], BLUE, "measured")
        draw_signal(above, part["reference"], ORANGE, "reference")
        above.set_ylabel(f"{quantity} [{unit}]")
        above.legend(loc="upper right")
        draw_signal(below, part["error"], RED, "error")
        below.set_ylabel(f"error [{unit}]")
        below.set_title(f"rms {rms(part['error']):.3g} {unit}, largest {part['error'].abs().max():.3g} {unit}", fontsize=9)
    axes[-1].set_xlabel("time [s]")
    return figure


def friction(bag: Bag, namespace: str = "") -> Figure:
    """Measured and estimated friction torque over time, and their difference at common times."""
    measured = bag.table("joint_states", namespace)
    _need(bag, measured, ["torque_Nm"], topic_name("joint_states", namespace))
    estimate = bag.table("friction_estimate", namespace)
    figure, axes = _figure("Friction, measured and estimated", 2)
    draw_signal(axes[0], measured["torque_Nm"], BLUE, "measured")
    draw_signal(axes[0], estimate["torque_Nm"], ORANGE, "estimated")
    axes[0].set_ylabel("friction torque [N m]")
    axes[0].legend(loc="upper right")
    difference = (_unique(measured["torque_Nm"]) - _unique(estimate["torque_Nm"])).dropna()
    draw_signal(axes[1], difference, RED, "measured minus estimated")
    axes[1].set_ylabel("difference [N m]")
    if len(difference):
        axes[1].set_title(f"rms {rms(difference):.3g} N m", fontsize=9)
    axes[1].set_xlabel("time [s]")
    return figure


def command_parts(bag: Bag, namespace: str = "") -> Figure:
    """The parts of the voltage over time: linear law, plant inverse, friction, dither, and what was sent."""
    state = bag.table("controller_state", namespace)
    figure, axes = _figure("Parts of the command", 1)
    colors = {"total_V": GREY, "linear_V": BLUE, "inverse_V": GREEN, "friction_V": ORANGE, "dither_V": RED}
    for column, color in colors.items():
        # A part that is not used would only hide the others.
        if column in state and (column == "total_V" or state[column].abs().max() > 0.0):
            draw_signal(axes[0], state[column], color, column.removesuffix("_V"))
    axes[0].set_ylabel("voltage [V]")
    axes[0].set_xlabel("time [s]")
    axes[0].legend(loc="upper right")
    return figure


FIGURES: dict[str, Callable[..., Figure]] = {
    "stribeck": stribeck_curve,
    "tracking": tracking,
    "friction": friction,
    "command": command_parts,
}
TOPICS = ("joint_states", "friction_estimate", "controller_state")


def draw_signal(ax: Axes, signal: pd.Series[float], color: str, label: str) -> None:
    """Draws a signal over its index: broken where nothing was recorded, thinned to what a page can show."""
    time, value = thinned(np.asarray(signal.index, dtype=np.float64), np.asarray(signal, dtype=np.float64))
    ax.plot(time, value, color=color, lw=0.8, label=label)
    ax.grid(alpha=0.3)
    ax.margins(x=0)


def thinned(time: Array, value: Array, most: int = 4000) -> tuple[Array, Array]:
    """At most about `most` points of a signal, with the extremes of every stretch, and a gap where there is one.

    A gap is twenty times the median period, and .1 s at least.
    """
    if len(time) < 2:
        return time, value
    steps = np.diff(time)
    gaps = np.flatnonzero(steps > max(20.0 * float(np.median(steps)), 0.1)) + 1
    times: list[Array] = []
    values: list[Array] = []
    for t, v in zip(np.split(time, gaps), np.split(value, gaps), strict=True):
        stretch = max(1, -(-2 * len(time) // most))
        kept = np.arange(len(t))
        if stretch > 1 and len(t) > 2 * stretch:
            whole = len(t) // stretch * stretch
            rows = np.where(np.isfinite(v[:whole]), v[:whole], 0.0).reshape(-1, stretch)
            base = np.arange(0, whole, stretch)
            ends = [base + rows.argmin(axis=1), base + rows.argmax(axis=1), [0, len(t) - 1]]
            kept = np.unique(np.concatenate(ends).astype(np.int64))
        times += [t[kept], np.array([np.nan])]
        values += [v[kept], np.array([np.nan])]
    return np.concatenate(times[:-1]), np.concatenate(values[:-1])


def rms(signal: pd.Series[float]) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(signal.to_numpy(dtype=np.float64)))))


def _unique(signal: pd.Series[float]) -> pd.Series[float]:
    return signal[~signal.index.duplicated(keep="last")]


def _need(bag: Bag, table: pd.DataFrame, columns: list[str], topic: str) -> None:
    if missing := [column for column in columns if column not in table]:
        raise BagError(f"{topic} in {bag.path} has no {' and no '.join(missing)}; it has {', '.join(table.columns)}")


def _figure(title: str, rows: int) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(9.0, 2.0 + 2.0 * rows if rows > 1 else 5.0), layout="constrained")
    figure.suptitle(title)
    shared = rows > 1
    axes = figure.subplots(rows, 1, sharex=shared, squeeze=False)
    return figure, list(axes[:, 0])


def main(arguments: list[str] | None = None) -> int:
    """The command `friction-plot`."""
    parser = command("friction-plot", __doc__ or "")
    parser.add_argument("bag", type=Path, metavar="BAG", help="bag folder or .mcap file")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder of the figures (default: figures, beside the bag)")
    parser.add_argument("--figure", action="append", choices=FIGURES, help="only this one; may come several times (default: all)")
    parser.add_argument("--format", choices=("png", "svg", "pdf"), default="png", help="default: png")
    parser.add_argument("--namespace", default="", metavar="NS", help="namespace of the axis, as in axis_1 (default: none)")
    parser.add_argument("--from", dest="start", type=float, metavar="S", help="only what comes after this time of the bag [s]")
    parser.add_argument("--to", dest="stop", type=float, metavar="S", help="only what comes before this time of the bag [s]")
    parser.add_argument(
        "--average",
        type=positive,
        default=0.01,
        metavar="S",
        help="averaging before the Stribeck curve's bins [s] (default: 0.01)",
    )
    given = parser.parse_args(arguments)

    def work() -> int:
        topics = [topic_name(name, given.namespace) for name in TOPICS]
        bag = read_bag(given.bag, topics, given.start, given.stop)
        out = given.out or given.bag.resolve().parent / "figures"
        out.mkdir(parents=True, exist_ok=True)
        drawn = 0
        for name in given.figure or FIGURES:
            extra = {"average": given.average} if name == "stribeck" else {}
            try:
                figure = FIGURES[name](bag, given.namespace, **extra)
            except BagError as error:
                print(f"left out {name}: {error}", file=sys.stderr)
                continue
            file = out / f"{name}.{given.format}"
            figure.savefig(file, dpi=150)
            print(file)
            drawn += 1
        if drawn == 0:
            raise BagError(f"{given.bag} has nothing that a figure could show")
        return 0

    return conclude(work)


if __name__ == "__main__":
    sys.exit(main())
