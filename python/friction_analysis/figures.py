"""The figures of a bag, with no ROS: Stribeck curve, tracking and error, friction against its estimate, parts of the command.

  friction-plot runs/all-1/bag                       figures beside the bag, in runs/all-1/figures
  friction-plot runs/all-1/bag --figure stribeck --average 0.1 --format pdf
  friction-plot twin/bag --namespace axis_1 --from 2 --to 4

  friction-plot runs/all-1/bag --run 45 --run 46

A bag of several runs is taken apart: each run is drawn from its own start, those of one experiment in one figure. The Stribeck
curve has no fit: means of the measured friction torque, one a run at constant velocity, and over bins of velocity where it
varies. A figure whose topics were not recorded is left out, and that is told.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction_analysis.bag import Bag, BagError, read_bag
from friction_analysis.console import Progress, command, conclude, positive
from friction_analysis.runs import Run, chosen, constant_reference, part, runs_of
from friction_analysis.stribeck import binned, sliding, steady_point
from friction_analysis.topics import topic_name

Array = npt.NDArray[np.float64]

# Modes of friction_msgs/msg/ControllerState: name and unit of what is regulated.
MODES = {0: ("velocity", "rad/s"), 1: ("position", "rad")}
BLUE, ORANGE, GREEN, RED, GREY = "#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#7f7f7f"


def stribeck_curve(bag: Bag, namespace: str = "", average: float = 0.01, travel: float = 0.01) -> Figure:
    """Friction torque over velocity: means of the runs at constant velocity, and of bins of all other motion.

    A run at constant velocity is one point: its mean without the first fifth and the last tenth. Samples of other motion are
    averaged over `average` [s] first, which takes noise off the velocity and must be short against the motion. What is
    slower than the noise, and the first `travel` [rad] after each standstill or turn, does not count: there the contact is
    a spring, and its torque is anything between the levels of friction.
    """
    measured = bag.table("joint_states", namespace)
    _need(bag, measured, ["velocity_rad_s", "torque_Nm"], topic_name("joint_states", namespace))
    figure, axes = _figure("Friction over velocity", 1)
    ax = axes[0]
    steady: list[tuple[float, float, float]] = []
    moving: dict[str, list[pd.DataFrame]] = {"joint_states": [], "friction_estimate": []}
    for run in runs_of(bag, namespace):
        piece = part(bag, run)
        if not piece.has("joint_states", namespace):
            continue
        if constant_reference(piece, namespace) is not None:
            point = steady_point(piece.table("joint_states", namespace), travel)
            steady += [point] if point else []
            continue
        for name, found in moving.items():
            if piece.has(name, namespace):
                found.append(sliding(piece.table(name, namespace)[["velocity_rad_s", "torque_Nm"]], average, travel))
    curves = {name: pd.concat(tables) for name, tables in moving.items() if any(len(table) for table in tables)}
    points = {name: binned(samples["velocity_rad_s"], samples["torque_Nm"]) for name, samples in curves.items()}
    if len(measured_points := points.get("joint_states", pd.DataFrame())):
        draw_curve(ax, measured_points, BLUE, "measured")
    if len(estimated := points.get("friction_estimate", pd.DataFrame())):
        ax.plot(estimated["velocity_rad_s"], estimated["torque_Nm"], ".", color=ORANGE, label="estimated")
    if steady:
        velocity, torque, deviation = (np.array(values) for values in zip(*sorted(steady), strict=True))
        ax.errorbar(velocity, torque, deviation, fmt="s", color=GREEN, ms=4, lw=1, label=f"constant velocity, {len(steady)} runs")
        _velocity_axis(ax, velocity)
    if not ax.has_data():
        raise BagError(f"{bag.path} shows no sliding: every motion is slower than its noise or shorter than {travel:g} rad")
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
        label = "_" if side.any() else label
    _velocity_axis(ax, velocity)


def _velocity_axis(ax: Axes, velocity: Array) -> None:
    slowest = float(np.abs(velocity).min()) if len(velocity) else 1e-3
    # The stretch around standstill, where there are no points, is drawn short.
    ax.set_xscale("symlog", linthresh=slowest, linscale=0.5)
    ax.set_xlabel("velocity [rad/s]")
    ax.set_ylabel("friction torque [N m]")
    ax.grid(alpha=0.3)


def tracking(bag: Bag, namespace: str = "", runs: Sequence[Run] = ()) -> Figure:
    """Reference, feedback and error over time, of velocity and of position as far as each was regulated.

    With `runs` each of them from its own start, else the whole bag.
    """
    states = [(run, piece.table("controller_state", namespace)) for run, piece in _pieces(bag, runs)]
    modes = [mode for mode in MODES if any((state["mode"] == mode).any() for _, state in states)]
    if not modes:
        raise BagError(f"{bag.path} has no {topic_name('controller_state', namespace)} in a known mode, 0 or 1")
    figure, axes = _figure(_title("Tracking", runs), 2 * len(modes))
    for index, mode in enumerate(modes):
        quantity, unit = MODES[mode]
        above, below = axes[2 * index], axes[2 * index + 1]
        parts = [(run, state[state["mode"] == mode]) for run, state in states if (state["mode"] == mode).any()]
        several = len(parts) > 1
        drawn: list[pd.Series[float]] = []
        for number, (run, state) in enumerate(parts):
            color = f"C{number}" if several else BLUE
            draw_signal(above, state["feedback"], color, run.label if run and several else "measured")
            # Runs of one task have one reference.
            if not any(state["reference"].equals(other) for other in drawn):
                draw_signal(above, state["reference"], "black" if several else ORANGE, "_" if drawn else "reference")
                drawn.append(state["reference"])
            figures = f"rms {rms(state['error']):.3g} {unit}, largest {state['error'].abs().max():.3g} {unit}"
            label = f"{run.label}: {figures}" if run and several else "error"
            draw_signal(below, state["error"], color if several else RED, label)
            if not several:
                below.set_title(figures, fontsize=9)
        above.set_ylabel(f"{quantity} [{unit}]")
        above.legend(loc="upper right", fontsize=8)
        below.set_ylabel(f"error [{unit}]")
        if several:
            below.legend(loc="upper right", fontsize=8)
    axes[-1].set_xlabel("time [s]")
    return figure


def friction(bag: Bag, namespace: str = "", runs: Sequence[Run] = ()) -> Figure:
    """Measured and estimated friction torque over time, and their difference at common times.

    With `runs` one panel each, from its own start, else the whole bag.
    """
    _need(bag, bag.table("joint_states", namespace), ["torque_Nm"], topic_name("joint_states", namespace))
    bag.table("friction_estimate", namespace)
    pieces = _pieces(bag, runs)
    figure, axes = _figure(_title("Friction, measured and estimated", runs), len(pieces) + 1)
    for number, ((run, piece), ax) in enumerate(zip(pieces, axes[:-1], strict=True)):
        measured = piece.table("joint_states", namespace)
        estimate = piece.table("friction_estimate", namespace)
        draw_signal(ax, measured["torque_Nm"], BLUE, "measured")
        draw_signal(ax, estimate["torque_Nm"], ORANGE, "estimated")
        ax.set_ylabel("friction torque [N m]")
        ax.legend(loc="upper right", fontsize=8)
        difference = (_unique(measured["torque_Nm"]) - _unique(estimate["torque_Nm"])).dropna()
        label = run.label if run and len(pieces) > 1 else "measured minus estimated"
        draw_signal(axes[-1], difference, RED if len(pieces) == 1 else f"C{number}", label)
        told = f"rms {rms(difference):.3g} N m" if len(difference) else ""
        if len(pieces) > 1 and run:
            ax.set_title(run.label, fontsize=9)
        elif told:
            axes[-1].set_title(told, fontsize=9)
    axes[-1].set_ylabel("difference [N m]")
    if len(pieces) > 1:
        axes[-1].legend(loc="upper right", fontsize=8)
    axes[-1].set_xlabel("time [s]")
    return figure


def command_parts(bag: Bag, namespace: str = "", runs: Sequence[Run] = ()) -> Figure:
    """The parts of the voltage over time: linear law, plant inverse, friction, dither, and what was sent.

    With `runs` one panel each, from its own start, else the whole bag.
    """
    bag.table("controller_state", namespace)
    pieces = _pieces(bag, runs)
    figure, axes = _figure(_title("Parts of the command", runs), len(pieces))
    colors = {"total_V": GREY, "linear_V": BLUE, "inverse_V": GREEN, "friction_V": ORANGE, "dither_V": RED}
    for (run, piece), ax in zip(pieces, axes, strict=True):
        state = piece.table("controller_state", namespace)
        for column, color in colors.items():
            # A part that is not used would only hide the others.
            if column in state and (column == "total_V" or state[column].abs().max() > 0.0):
                draw_signal(ax, state[column], color, column.removesuffix("_V"))
        ax.set_ylabel("voltage [V]")
        ax.legend(loc="upper right", fontsize=8)
        if run and len(pieces) > 1:
            ax.set_title(run.label, fontsize=9)
    axes[-1].set_xlabel("time [s]")
    return figure


def _pieces(bag: Bag, runs: Sequence[Run]) -> list[tuple[Run | None, Bag]]:
    return [(run, part(bag, run)) for run in runs] if runs else [(None, bag)]


def _title(title: str, runs: Sequence[Run]) -> str:
    experiments = {run.experiment for run in runs if run.experiment}
    return f"{title}: {', '.join(sorted(experiments))}" if experiments else title


FIGURES: dict[str, Callable[..., Figure]] = {
    "stribeck": stribeck_curve,
    "tracking": tracking,
    "friction": friction,
    "command": command_parts,
}
TOPICS = ("joint_states", "friction_estimate", "controller_state", "experiment_status")
# Runs of one experiment in a figure over time.
MOST_RUNS = 6


def draw_signal(ax: Axes, signal: pd.Series[float], color: str, label: str) -> None:
    """Draws a signal over its index: broken where nothing was recorded, thinned to what a page can show."""
    time, value = thinned(np.asarray(signal.index, dtype=np.float64), np.asarray(signal, dtype=np.float64))
    ax.plot(time, value, color=color, lw=0.8, label=label)
    ax.grid(alpha=0.3)
    ax.margins(x=0)


def thinned(time: Array, value: Array, most: int = 4000) -> tuple[Array, Array]:
    """At most about `most` points of a signal, with the extremes of every stretch, and a gap where there is one.

    A gap is twenty times the median period, and 0.1 s at least.
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
    parser.add_argument(
        "--travel",
        type=positive,
        default=0.01,
        metavar="RAD",
        help="way after each standstill that the Stribeck curve leaves out [rad] (default: 0.01)",
    )
    parser.add_argument(
        "--run",
        dest="runs",
        type=_numbers,
        action="append",
        metavar="N",
        help="only this run; may come several times (default: all)",
    )
    given = parser.parse_args(arguments)

    def work() -> int:
        topics = [topic_name(name, given.namespace) for name in TOPICS]
        bag = read_bag(given.bag, topics, given.start, given.stop, Progress(f"reading {given.bag}"))
        runs = runs_of(bag, given.namespace)
        if given.runs:
            runs = _asked(runs, given.runs)
        elif len(runs) > 1:
            print(f"{given.bag}: {_listed(runs)}", file=sys.stderr)
        out = given.out or given.bag.resolve().parent / "figures"
        out.mkdir(parents=True, exist_ok=True)
        drawn = 0
        names = given.figure or list(FIGURES)
        told = Progress("drawing")
        for number, name in enumerate(names):
            told(number / len(names))
            try:
                for stem, figure in _figures(name, bag, runs, given):
                    file = out / f"{stem}.{given.format}"
                    figure.savefig(file, dpi=150)
                    print(file, flush=True)
                    drawn += 1
            except BagError as error:
                print(f"left out {name}: {error}", file=sys.stderr)
        told(1.0)
        if drawn == 0:
            raise BagError(f"{given.bag} has nothing that a figure could show")
        return 0

    return conclude(work)


def _figures(name: str, bag: Bag, runs: list[Run], given: argparse.Namespace) -> Iterator[tuple[str, Figure]]:
    """The figures of one kind with the stems of their files: the Stribeck curve of all, the others of each experiment."""
    if name == "stribeck":
        if not runs:
            bag.table("joint_states", given.namespace)
        yield name, stribeck_curve(bag, given.namespace, given.average, given.travel)
        return
    experiments = {run.experiment: [other for other in runs if other.experiment == run.experiment] for run in runs}
    if len(runs) <= 1:
        yield name, FIGURES[name](bag, given.namespace, runs)
        return
    for experiment, its in experiments.items():
        shown = its if given.runs else chosen(its, MOST_RUNS)
        word = re.sub(r"[^a-z0-9]+", "-", experiment.lower()).strip("-")
        yield f"{name}-{word}" if len(experiments) > 1 and word else name, FIGURES[name](bag, given.namespace, shown)


def _asked(runs: list[Run], numbers: list[int]) -> list[Run]:
    if unknown := [number for number in numbers if not 1 <= number <= len(runs)]:
        raise BagError(f"there is no run {unknown[0]}; the bag has runs 1 to {len(runs)}")
    return [runs[number - 1] for number in numbers]


def _listed(runs: list[Run]) -> str:
    """The runs in a few lines: those of one experiment together."""
    lines = [f"{len(runs)} runs; --run N draws those that you name"]
    for experiment in dict.fromkeys(run.experiment for run in runs):
        its = [run for run in runs if run.experiment == experiment]
        seconds = sum(run.stop_s - run.start_s for run in its)
        named = experiment or "no experiment named"
        drawn = ", ".join(str(run.number) for run in chosen(its, MOST_RUNS))
        shown = "" if len(its) <= MOST_RUNS else f"; the figures over time show {drawn}"
        lines.append(f"  {its[0].number} to {its[-1].number}: {named}, {len(its)} runs, {seconds:.0f} s{shown}")
    return "\n".join(lines)


def _numbers(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"the number of a run was expected, but {text!r} came") from None


if __name__ == "__main__":
    sys.exit(main())
