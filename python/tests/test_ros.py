"""The commands that speak ROS, against a stand-in made with rclpy, and against the real experiment runner where it can be had.

Only with FRICTION_ROS_TESTS=1: what is published here would be heard by every ROS program on the network, so the tests of the
workspace (`cargo test -p tests --test python_package`) run them in a network namespace of their own.
"""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

if os.environ.get("FRICTION_ROS_TESTS") != "1":
    pytest.skip("FRICTION_ROS_TESTS is not 1", allow_module_level=True)
pytest.importorskip("rclpy")

PACKAGE = Path(__file__).resolve().parents[1]
PATIENCE = 120


def command(module, *arguments):
    environment = {**os.environ, "PYTHONPATH": f"{PACKAGE}{os.pathsep}{os.environ.get('PYTHONPATH', '')}", "MPLBACKEND": "Agg"}
    return subprocess.Popen(
        [sys.executable, "-m", f"friction_analysis.{module}", *map(str, arguments)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Whoever runs the tests in the background of a shell has SIGINT ignored, and so would the command.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def run(module, *arguments):
    process = command(module, *arguments)
    out, err = process.communicate(timeout=PATIENCE)
    assert "Traceback" not in err, err
    return process.returncode, out, err


@pytest.fixture(scope="module")
def stand_in():
    pytest.importorskip("friction_msgs.action", reason="this friction_msgs has no RunExperiment")
    namespace = "/axis_1"
    process = subprocess.Popen(
        [sys.executable, Path(__file__).with_name("stand_in.py"), namespace],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "ready\n"
    yield namespace
    process.stdin.close()
    try:
        process.wait(timeout=30)
    except subprocess.TimeoutExpired:
        process.kill()
        raise


def test_a_picture_of_the_running_rig_is_taken_without_a_display(stand_in, tmp_path):
    picture = tmp_path / "now.png"
    code, out, err = run("live", "--namespace", stand_in, "--once", "4", "--out", picture)
    assert code == 0, err
    assert picture.read_bytes().startswith(b"\x89PNG")
    for topic in ("joint_states", "friction_estimate", "controller_state", "reference"):
        count = int(re.search(rf"{topic} (\d+)", out).group(1))
        assert count > 100, out


def test_a_window_without_a_display_is_refused_with_the_way_out(stand_in):
    code, _, err = run("live", "--namespace", stand_in)
    assert code == 2
    assert "--once SECONDS --out FILE.png" in err


def test_nobody_there_is_told_with_where_was_looked(tmp_path):
    code, _, err = run("live", "--namespace", "nobody", "--wait", "1", "--once", "1", "--out", tmp_path / "x.png")
    assert code == 2
    assert "/nobody/joint_states" in err and "ROS_DOMAIN_ID" in err
    assert not (tmp_path / "x.png").exists()


def test_an_experiment_runs_to_its_end_with_feedback_and_figures(stand_in, tmp_path):
    told = tmp_path / "result.json"
    given = ["--model", "lugre", "--model", "dahl", "--repetitions", "3", "--set", "quick=true", "--json", told]
    code, out, err = run("experiment", "steady", "--namespace", stand_in, *given)
    assert code == 0, err
    assert "first half, repetition 1" in err and "second half" in err
    assert "models ['lugre', 'dahl'], repetitions 3, overrides {'quick': 'true'}" in out
    assert "velocity tracking | lugre | mse | 2.5e-05 (rad/s)^2" in out
    result = json.loads(told.read_text(encoding="utf-8"))
    assert result["outcome"] == "SUCCEEDED"
    assert result["parameters"][0]["name"] == "f_s" and result["parameters"][0]["value"] == 0.1
    assert result["figures"][0]["deviation"] is None


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupt_cancels_the_experiment_and_waits_for_its_result(stand_in, number):
    process = command("experiment", "endless", "--namespace", stand_in)
    # The first lines of progress say that it runs, and goes on.
    assert "first half" in process.stderr.readline()
    assert "second half" in process.stderr.readline()
    process.send_signal(number)
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130, err
    assert re.search(r"canceled: cancelled after \d+ steps", err), err
    assert "Traceback" not in err


def test_refusals_and_failures_are_told_apart(stand_in):
    code, _, err = run("experiment", "jump", "--namespace", stand_in, "--quiet")
    assert (code, "there is no experiment `jump`" in err) == (2, True), err
    code, _, err = run("experiment", "broken", "--namespace", stand_in, "--quiet")
    assert (code, "the rig does not answer" in err) == (1, True), err
    code, _, err = run("experiment", "steady", "--namespace", "nobody", "--wait", "1")
    assert code == 2
    assert "nobody offers /nobody/experiment_runner/run_experiment" in err


def test_the_real_experiment_runner_is_listed_and_run(tmp_path):
    pytest.importorskip("friction_msgs.action", reason="this friction_msgs has no RunExperiment")
    program = os.environ.get("FRICTIONLAB_BIN")
    if not program or subprocess.run([program, "serve", "--help"], capture_output=True, check=False).returncode != 0:
        pytest.skip("FRICTIONLAB_BIN names no frictionlab with `serve`")
    server = subprocess.Popen([program, "serve", "--quiet", "--runs", tmp_path / "runs"])
    try:
        code, out, err = run("experiment", "--list", "--wait", "60")
        assert code == 0, err
        assert "position-tracking" in out and "  seed: " in out
        given = ["--set", "quick=true", "--repetitions", "1", "--json", tmp_path / "result.json"]
        code, out, err = run("experiment", "constant-velocity", *given)
        assert code == 0, err
        result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
        assert (Path(result["bag_path"]) / "metadata.yaml").is_file()
        code, _, err = run("experiment", "positon-tracking", "--quiet")
        assert code == 2
        assert "position-tracking" in err
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(timeout=60)
