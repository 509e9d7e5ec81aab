"""A bag of several runs: constant velocities, then the same motion under two compensations, with pauses between them."""

import io

import numpy as np
import pytest
from conftest import START, coulomb_viscous, store
from rosbags.rosbag2 import StoragePlugin, Writer

from friction_analysis import read_bag
from friction_analysis.console import Progress
from friction_analysis.figures import main, stribeck_curve, tracking
from friction_analysis.runs import chosen, part, runs_of

SPEEDS = [0.005, 0.05, 0.2, 1.0, 3.0]
NOISE = 0.02


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    """Five runs of six seconds at 50 Hz, an hour of nothing, two runs of four seconds at 500 Hz; the tachometer is noisy."""
    path = tmp_path_factory.mktemp("several") / "bag"
    types = store()
    kinds = types.types
    random = np.random.default_rng(1)
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        names = {
            "/joint_states": "sensor_msgs/msg/JointState",
            "/controller_state": "friction_msgs/msg/ControllerState",
            "/experiment_status": "friction_msgs/msg/ExperimentStatus",
        }
        connections = {topic: writer.add_connection(topic, kind, typestore=types) for topic, kind in names.items()}

        def put(topic, stamp, **values):
            time = kinds["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
            message = kinds[names[topic]](header=kinds["std_msgs/msg/Header"](time, ""), **values)
            writer.write(connections[topic], stamp, types.serialize_cdr(message, names[topic]))

        def status(stamp, experiment, stage):
            put("/experiment_status", stamp, experiment=experiment, stage=stage, repetition=0, progress=0.0, remaining=0.0,
                bag_path="", message="")  # fmt: skip

        def cycle(stamp, reference, velocity, torque):
            put("/joint_states", stamp, name=["load_shaft"], position=np.array([0.0]), effort=np.array([torque]),
                velocity=np.array([velocity + random.normal(0.0, NOISE)]))  # fmt: skip
            put("/controller_state", stamp, mode=0, reference=reference, feedback=velocity, error=reference - velocity,
                linear=1.0, inverse=0.0, friction=0.0, dither=0.0, total=1.0, saturated=False)  # fmt: skip

        stamp = START
        for number, speed in enumerate(SPEEDS):
            if number == 0:
                status(stamp, "constant-velocity", "set 1 of 1")
            for n in range(300):
                cycle(stamp + n * 20_000_000, speed, speed, float(coulomb_viscous(speed)))
            stamp += 7_000_000_000
        stamp += 3600 * 10**9
        for name in ("none", "lugre"):
            status(stamp, "velocity tracking", f"compensation {name}")
            for n in range(2000):
                t = n * 0.002
                reference = 0.5 * np.sin(np.pi * t / 2.0)
                # The first half second the shaft sticks, and the torque is anything.
                stuck = t < 0.5
                torque = 0.09 * t / 0.5 if stuck else float(coulomb_viscous(reference))
                cycle(stamp + n * 2_000_000, reference, 0.0 if stuck else reference, torque)
            stamp += 5_000_000_000
    return path


def test_runs_are_told_apart_by_pauses_and_marks(several):
    bag = read_bag(several)
    runs = runs_of(bag)
    assert [run.number for run in runs] == list(range(1, 8))
    assert [run.label for run in runs] == ["set 1 of 1"] * 5 + ["none", "lugre"]
    assert [run.experiment for run in runs] == ["constant-velocity"] * 5 + ["velocity tracking"] * 2
    assert runs[5].start_s == pytest.approx(3635.0)
    piece = part(bag, runs[6]).table("joint_states")
    assert len(piece) == 2000 and piece.index[0] == 0.0 and piece.index[-1] == pytest.approx(3.998)
    assert [run.number for run in chosen(runs[:5], 3)] == [1, 3, 5]
    assert [run.number for run in chosen([runs[0], *runs[5:] * 2], 4)] == [1, 6, 7]
    # Without marks the pauses are enough.
    assert len(runs_of(read_bag(several, ["/joint_states"]))) == 7


def test_the_friction_curve_does_not_fall_to_zero_where_the_shaft_stands(several):
    ax = stribeck_curve(read_bag(several)).axes[0]
    for line in ax.get_lines():
        velocity, torque = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
        if len(velocity) > 2 and line.get_marker() != "_":
            assert np.abs(torque - coulomb_viscous(velocity)).max() < 0.01, line.get_label()
    steady = ax.containers[0].lines[0]
    # The slowest run is slower than its noise, which a mean takes off.
    assert np.allclose(steady.get_xdata(), SPEEDS, atol=0.01)
    assert np.allclose(steady.get_ydata(), coulomb_viscous(np.array(SPEEDS)), atol=1e-12)


def test_each_run_is_drawn_from_its_own_start(several):
    bag = read_bag(several)
    figure = tracking(bag, runs=runs_of(bag)[5:])
    for ax in figure.axes:
        low, high = ax.get_xlim()
        assert low > -0.5 and high < 4.5, "seconds of the motion, not of the day"
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert labels == ["none", "reference", "lugre"]


def test_the_command_draws_a_figure_an_experiment_and_tells_how_far_it_is(several, tmp_path, capsys):
    assert main([str(several), "--out", str(tmp_path)]) == 0
    stems = sorted(file.stem for file in tmp_path.iterdir())
    assert stems == [
        "command-constant-velocity",
        "command-velocity-tracking",
        "stribeck",
        "tracking-constant-velocity",
        "tracking-velocity-tracking",
    ]
    told = capsys.readouterr().err
    assert "7 runs" in told and "6 to 7: velocity tracking, 2 runs" in told
    assert main([str(several), "--out", str(tmp_path / "one"), "--figure", "tracking", "--run", "7"]) == 0
    assert [file.name for file in (tmp_path / "one").iterdir()] == ["tracking.png"]
    assert main([str(several), "--out", str(tmp_path), "--run", "9"]) == 2
    assert "the bag has runs 1 to 7" in capsys.readouterr().err


def test_progress_is_told_off_a_terminal_too():
    stream = io.StringIO()
    told = Progress("reading a bag", stream, every=0.0)
    for share in (0.0, 0.5, 1.0):
        told(share)
    assert stream.getvalue().splitlines() == ["reading a bag: 0 %", "reading a bag: 50 %", "reading a bag: 100 %"]


def test_reading_tells_its_share(several):
    shares = []
    read_bag(several, progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0
