"""Live plots of a running rig with rclpy: Stribeck curve as it grows, tracking, friction and its estimate.

  friction-live                                    a window with the last ten seconds; close it or press ctrl-C
  friction-live --namespace axis_2 --window 30
  friction-live --once 5 --out now.png             five seconds into a file, for machines without a display

Hears /joint_states, /friction_estimate, /controller_state and /reference, best effort: it never holds up whoever publishes.
Without friction_msgs it shows what /joint_states alone can tell. Needs a ROS 2 environment; `frictionlab live` or
`ros2 launch friction_bringup friction.launch.py` makes something to look at.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from friction_analysis.console import command, conclude, positive
from friction_analysis.figures import BLUE, GREY, MODES, ORANGE, RED, draw_curve, thinned
from friction_analysis.ros import RosError, SpinningNode, load, surroundings
from friction_analysis.signals import Recent, Signals
from friction_analysis.topics import topic_name

NAMES: dict[str, tuple[str, ...]] = {
    "joint_states": ("position", "velocity", "torque"),
    "friction_estimate": ("torque", "velocity"),
    "controller_state": ("mode", "reference", "feedback", "error"),
    "reference": ("position", "velocity"),
}


def listen(node: Any, signals: Signals, namespace: str = "") -> None:
    """Subscribes the topics on an rclpy node; what comes goes into `signals`."""
    qos = load("rclpy.qos")
    profile = qos.QoSProfile(depth=100, reliability=qos.ReliabilityPolicy.BEST_EFFORT)

    def joint_states(message: Any) -> None:
        # The laboratory's joint has all three; of other publishers, what is there.
        first = [float(values[0]) if len(values) else np.nan for values in (message.position, message.velocity, message.effort)]
        signals.add("joint_states", stamp(message), *first)
        signals.add_friction(first[1], first[2])

    def friction_estimate(message: Any) -> None:
        signals.add("friction_estimate", stamp(message), message.torque, message.velocity)

    def controller_state(message: Any) -> None:
        signals.add("controller_state", stamp(message), float(message.mode), message.reference, message.feedback, message.error)

    def reference(message: Any) -> None:
        signals.add("reference", stamp(message), message.position, message.velocity)

    def subscribe(kind: Any, name: str, heard: Any) -> None:
        node.create_subscription(kind, topic_name(name, namespace), heard, profile)

    subscribe(load("sensor_msgs.msg").JointState, "joint_states", joint_states)
    try:
        msgs = load("friction_msgs.msg")
    except RosError as error:
        print(f"only {topic_name('joint_states', namespace)} is shown: {error}", file=sys.stderr)
        return
    subscribe(msgs.FrictionEstimate, "friction_estimate", friction_estimate)
    subscribe(msgs.ControllerState, "controller_state", controller_state)
    subscribe(msgs.Reference, "reference", reference)


def stamp(message: Any) -> float:
    """The message's own time [s since 1970]."""
    return float(message.header.stamp.sec) + 1e-9 * float(message.header.stamp.nanosec)


class LivePlot:
    """Three plots on a figure: tracking, friction over time, Stribeck curve."""

    def __init__(self, figure: Figure) -> None:
        self._figure = figure
        grid = figure.add_gridspec(2, 2)
        self._tracking = figure.add_subplot(grid[0, 0])
        self._friction = figure.add_subplot(grid[1, 0])
        self._stribeck = figure.add_subplot(grid[:, 1])

    def draw(self, signals: Signals) -> None:
        """Draws what there is now."""
        for ax in (self._tracking, self._friction, self._stribeck):
            ax.clear()
        self._draw_tracking(signals)
        ax = self._friction
        _draw(ax, signals.recent("joint_states"), "torque", BLUE, "measured")
        _draw(ax, signals.recent("friction_estimate"), "torque", ORANGE, "estimated")
        ax.set_xlabel("time [s]")
        ax.set_ylabel("friction torque [N m]")
        _legend(ax)
        ax = self._stribeck
        draw_curve(ax, signals.curve().points(), BLUE, "means since the start")
        joints = signals.recent("joint_states")
        if len(joints):
            every = max(1, len(joints) // 2000)
            velocity, torque = joints.values["velocity"][::every], joints.values["torque"][::every]
            ax.plot(velocity, torque, ".", color=GREY, ms=1, alpha=0.4, zorder=0, label="the window's samples")
        _legend(ax)

    def _draw_tracking(self, signals: Signals) -> None:
        ax = self._tracking
        state = signals.recent("controller_state")
        if len(state):
            quantity, unit = MODES.get(int(state.values["mode"][-1]), ("?", "?"))
            _draw(ax, state, "feedback", BLUE, "measured")
            _draw(ax, state, "reference", ORANGE, "reference")
            _draw(ax, state, "error", RED, "error")
        else:
            # Nobody controls: velocity, and where it should be if somebody says so.
            quantity, unit = MODES[0]
            _draw(ax, signals.recent("joint_states"), "velocity", BLUE, "measured")
            _draw(ax, signals.recent("reference"), "velocity", ORANGE, "reference")
        ax.set_xlabel("time [s]")
        ax.set_ylabel(f"{quantity} [{unit}]")
        _legend(ax)


def _draw(ax: Axes, recent: Recent, name: str, color: str, label: str) -> None:
    if len(recent):
        ax.plot(*thinned(recent.time, recent.values[name]), color=color, lw=0.8, label=label)


def _legend(ax: Axes) -> None:
    ax.grid(alpha=0.3)
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper left", fontsize=8)


def _await_first(signals: Signals, topic: str, patience: float) -> None:
    end = time.monotonic() + patience
    while not any(signals.counts.values()):
        if time.monotonic() > end:
            raise RosError(f"no message on {topic} within {patience:g} s; is the rig running? {surroundings()}")
        time.sleep(0.02)


def once(signals: Signals, seconds: float, out: Path) -> None:
    """Listens for that time from the first message on and draws into a file."""
    time.sleep(seconds)
    figure = Figure(figsize=(12.0, 7.0), layout="constrained")
    LivePlot(figure).draw(signals)
    figure.savefig(out, dpi=120)
    heard = ", ".join(f"{name} {count} ({signals.rate(name):.0f} Hz)" for name, count in signals.counts.items() if count)
    print(f"{out}: {heard}")


def window(signals: Signals) -> None:
    """Draws into a window, five times a second, until it is closed."""
    import matplotlib.pyplot as plt

    if plt.get_backend().lower() in ("agg", "pdf", "svg", "ps", "cairo", "template"):
        raise RosError("no display was found; use --once SECONDS --out FILE.png, or install a matplotlib backend such as PyQt6")
    figure = plt.figure(figsize=(12.0, 7.0), layout="constrained")
    plot = LivePlot(figure)
    while plt.fignum_exists(figure.number):
        plot.draw(signals)
        plt.pause(0.2)


def main(arguments: list[str] | None = None) -> int:
    """The command `friction-live`."""
    parser = command("friction-live", __doc__ or "")
    parser.add_argument("--namespace", default="", metavar="NS", help="namespace of the axis, as in axis_1 (default: none)")
    parser.add_argument(
        "--window", type=positive, default=10.0, metavar="S", help="how much of the past is shown [s] (default: 10)"
    )
    parser.add_argument(
        "--wait", type=positive, default=15.0, metavar="S", help="longest wait for the first message [s] (default: 15)"
    )
    parser.add_argument(
        "--once", type=positive, metavar="S", help="listen this long [s], write --out and end; no display is needed"
    )
    parser.add_argument("--out", type=Path, metavar="FILE", help="picture that --once writes: .png, .svg or .pdf")
    given = parser.parse_args(arguments)
    if (given.once is None) != (given.out is None):
        parser.error("--once SECONDS and --out FILE belong together")

    def work() -> int:
        signals = Signals(NAMES, given.window if given.once is None else max(given.window, given.once))
        with SpinningNode("friction_live") as ros:
            listen(ros.node, signals, given.namespace)
            _await_first(signals, topic_name("joint_states", given.namespace), given.wait)
            if given.once is None:
                window(signals)
            else:
                once(signals, given.once, given.out)
        return 0

    return conclude(work)


if __name__ == "__main__":
    sys.exit(main())
