import threading

import numpy as np
import pytest
from matplotlib.figure import Figure

from friction_analysis.live import NAMES, LivePlot
from friction_analysis.signals import Signals


def test_the_window_keeps_the_last_seconds_of_every_topic():
    signals = Signals({"a": ("x",), "b": ("y", "z")}, window=2.0)
    for index in range(1001):
        signals.add("a", 100.0 + index * 0.01, float(index))
    signals.add("b", 109.5, 1.0, 2.0)
    signals.add("b", 104.0 + 5.9, 3.0, 4.0)
    recent = signals.recent("a")
    assert recent.time[0] == pytest.approx(-2.0) and recent.time[-1] == 0.0
    assert recent.values["x"][-1] == 1000.0
    assert signals.recent("b").values["z"].tolist() == [2.0, 4.0]
    assert signals.counts == {"a": 1001, "b": 2}
    assert signals.rate("a") == pytest.approx(100.0)
    assert signals.rate("b") == pytest.approx(1.0 / 0.4)


def test_a_topic_that_fell_silent_leaves_the_window():
    signals = Signals({"a": ("x",), "b": ("x",)}, window=1.0)
    signals.add("b", 0.0, 1.0)
    signals.add("a", 5.0, 1.0)
    assert len(signals.recent("b")) == 0


def test_a_clock_that_goes_back_begins_a_new_window():
    signals = Signals({"a": ("x",), "b": ("x",)}, window=10.0)
    signals.add("a", 1000.0, 1.0)
    signals.add("b", 1000.0, 1.0)
    signals.add("a", 3.0, 2.0)
    assert signals.recent("a").values["x"].tolist() == [2.0]
    assert len(signals.recent("b")) == 0


def test_the_curve_has_every_sample_however_they_are_read_in_between():
    signals = Signals({"a": ("x",)})
    for index in range(2500):
        signals.add_friction(1.0, 0.1 + 0.001 * (index % 3))
        if index % 700 == 0:
            signals.curve()
    points = signals.curve().points()
    assert points["count"].tolist() == [2500]
    assert points["torque_Nm"].iloc[0] == pytest.approx(0.1 + 0.001 * sum(index % 3 for index in range(2500)) / 2500)


def test_reading_while_samples_come_never_sees_half_of_one():
    signals = Signals({"a": ("x", "y")}, window=1e9)
    done = threading.Event()

    def feed():
        for index in range(20_000):
            signals.add("a", float(index), float(index), float(-index))
        done.set()

    thread = threading.Thread(target=feed)
    thread.start()
    while not done.is_set():
        recent = signals.recent("a")
        assert np.array_equal(recent.values["x"], -recent.values["y"])
    thread.join()


def test_wrong_numbers_of_values_are_told():
    with pytest.raises(ValueError, match="a has 1 values, but 2 came"):
        Signals({"a": ("x",)}).add("a", 0.0, 1.0, 2.0)


@pytest.mark.parametrize("mode", [0, 1, None])
def test_the_plot_draws_what_there_is(mode, tmp_path):
    signals = Signals(NAMES)
    for index in range(200):
        t, velocity = index * 0.01, np.cos(index * 0.05)
        signals.add("joint_states", t, 0.0, velocity, 0.1 * np.sign(velocity))
        signals.add_friction(velocity, 0.1 * np.sign(velocity))
        if mode is not None:
            signals.add("controller_state", t, float(mode), 1.0, 0.9, 0.1)
    figure = Figure()
    plot = LivePlot(figure)
    plot.draw(Signals(NAMES))
    plot.draw(signals)
    figure.savefig(tmp_path / "live.png")
    tracking, friction, stribeck = figure.axes
    assert tracking.get_ylabel() == {0: "velocity [rad/s]", 1: "position [rad]", None: "velocity [rad/s]"}[mode]
    assert len(tracking.get_lines()) == (1 if mode is None else 3)
    assert len(friction.get_lines()) == 1
    assert len(stribeck.get_lines()) == 3
