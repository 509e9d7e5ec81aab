"""Searches in shares: what comes of them is what one process finds, whatever happens to single shares."""

import json
import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest
from frictionlab import BadInput, Failure

pytest.importorskip("pyarrow")
pytest.importorskip("fsspec")
pytest.importorskip("scipy")

from frictionlab.fleet.search import search
from frictionlab.fleet.search.cli import main

# A program that can be cut: it squares numbers. What it meets in the folder TRAPS it does.
PROGRAM = """#!{python}
import json, os, pathlib, signal, sys, time
given = dict(zip(sys.argv[1::2], sys.argv[2::2])) if "--join" in sys.argv else {{}}
words = sys.argv[1:]
after = lambda name: words[words.index(name) + 1]
traps = pathlib.Path(os.environ["TRAPS"])
count, out = int(after("--count")), pathlib.Path(after("--out"))
if count < 0:
    print("--count must be a number from 0, but is", count, file=sys.stderr)
    sys.exit(2)
if "--join" in words:
    parts = sorted(pathlib.Path(after("--join")).glob("*.json"))
    print(sum((json.loads(part.read_text()) for part in parts), []))
    out.mkdir(exist_ok=True)
    (out / "squares.json").write_text("joined")
    sys.exit(0 if len(parts) == json.loads(parts[0].name[-10:-5].lstrip("0")) else 1)
number, of = map(int, after("--part").split("/"))
with (traps / f"{{number}}.did").open("a") as did:
    did.write("x")
out.mkdir()
if (traps / f"{{number}}.fails").exists():
    print("noise\\nthe disk is full", file=sys.stderr)
    sys.exit(1)
if (traps / f"{{number}}.dies").exists():
    os.kill(os.getpid(), signal.SIGKILL)
if (traps / f"{{number}}.hangs").exists():
    (traps / f"{{number}}.pid").write_text(f"{{os.getpid()}} {{out}}")
    time.sleep(600)
print(json.dumps([at * at for at in range(count * (number - 1) // of, count * number // of)]))
"""


@pytest.fixture
def traps(tmp_path, monkeypatch):
    folder = tmp_path / "traps"
    folder.mkdir()
    monkeypatch.setenv("TRAPS", str(folder))
    return folder


@pytest.fixture
def squares(tmp_path, traps):
    file = tmp_path / "squares"
    file.write_text(PROGRAM.format(python=sys.executable), encoding="utf-8")
    file.chmod(file.stat().st_mode | stat.S_IXUSR)
    return [str(file), "--count", "30"]


def done(traps):
    return {int(file.stem): len(file.read_text()) for file in traps.glob("*.did")}


def test_shares_are_joined_and_known_ones_are_not_done_again(squares, traps, tmp_path):
    out, counts = tmp_path / "out", []
    found = search(squares, out, shares=7, workers=2, on_progress=lambda count: counts.append(count.done))
    assert json.loads(found.text) == [at * at for at in range(30)] and found.failed == []
    assert counts == list(range(1, 8)) and done(traps) == dict.fromkeys(range(1, 8), 1)
    assert (found.out / "squares.json").read_text() == "joined"
    (out / "shares/part-00003-of-00007.json").unlink()
    assert search(squares, out, workers=1).text == found.text
    assert done(traps) == dict.fromkeys(range(1, 8), 1) | {3: 2}
    with pytest.raises(BadInput, match="in 7 shares; give the same"):
        search(squares, out, shares=8)
    with pytest.raises(BadInput, match="holds a search of"):
        search([*squares, "--more"], out)


def test_a_share_that_fails_is_told_and_tried_again_the_next_time(squares, traps, tmp_path, capsys):
    (traps / "2.fails").touch()
    (traps / "5.dies").touch()
    line = ["--out", str(tmp_path / "out"), "--shares", "5", "--workers", "2", "--quiet", "--", *squares]
    assert main(line) == 1
    said = capsys.readouterr()
    assert json.loads(said.out) == [at * at for at in range(24) if not 6 <= at < 12]
    assert (
        "share 2 of 5: the disk is full" in said.err and "share 5 of 5: " in said.err and "2 shares came to nothing" in said.err
    )
    for trap in traps.iterdir():
        trap.unlink()
    assert main(line) == 0
    assert json.loads(capsys.readouterr().out) == [at * at for at in range(30)]
    assert done(traps) == {2: 1, 5: 1}


def test_a_share_that_takes_too_long_is_given_up_with_all_that_it_left(squares, traps, tmp_path):
    (traps / "1.hangs").touch()
    # The other share starts a Python, which takes seconds where all processors are busy.
    found = search(squares, tmp_path / "out", shares=2, workers=1, longest_s=20.0)
    assert len(found.failed) == 1 and "share 1 of 2: it took longer than 20 s" in found.failed[0]
    assert_gone(traps / "1.pid")


def assert_gone(file):
    """The program and its folder are there no longer."""
    pid, out = file.read_text().split()
    for _ in range(600):
        if not Path(f"/proc/{pid}").exists() and not Path(out).parent.exists():
            return
        time.sleep(0.1)
    raise AssertionError("the program or its folder is still there")


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="processes are looked for in /proc")
@pytest.mark.parametrize("ends", [signal.SIGINT, signal.SIGKILL])
def test_no_program_outlives_a_search_that_is_ended(ends, squares, traps, tmp_path):
    (traps / "2.hangs").touch()
    out = tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "frictionlab.fleet.search",
        "--out",
        str(out),
        "--shares",
        "3",
        "--workers",
        "2",
        "--",
        *squares,
    ]
    running = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        while not ((traps / "2.pid").exists() and len(list(out.glob("shares/*.json"))) == 2):
            assert running.poll() is None
            time.sleep(0.05)
        running.send_signal(ends)
        assert running.wait(timeout=60) == (130 if ends == signal.SIGINT else -ends)
    finally:
        running.kill()
        running.wait()
    assert_gone(traps / "2.pid")
    (traps / "2.hangs").unlink()
    assert json.loads(search(squares, out).text) == [at * at for at in range(30)]
    assert done(traps) == {1: 1, 2: 2, 3: 1}


@pytest.mark.parametrize(
    ("command", "keywords", "said"),
    [
        ([], {}, "expected a program"),
        ("frictionlab monte-carlo", {}, "expected a program"),
        (["no-such-program"], {}, "there is no program no-such-program"),
        ([sys.executable, "--out=x"], {}, "--out=x is given by the search itself"),
        ([sys.executable], {"shares": 0}, "number of shares must be from 1"),
        ([sys.executable], {"longest_s": float("nan")}, "longest time for a share"),
        ([sys.executable], {"engine": "spark"}, "expected the engine"),
        ([sys.executable], {"workers": 0}, "there must be a worker"),
    ],
)
def test_bad_input_is_a_sentence(command, keywords, said, tmp_path):
    with pytest.raises(BadInput, match=said):
        search(command, tmp_path / "out", **keywords)


def test_a_command_that_refuses_its_options_is_asked_no_further(squares, traps, tmp_path):
    with pytest.raises(BadInput, match="--count must be a number from 0, but is -1"):
        search([squares[0], "--count", "-1"], tmp_path / "out", shares=100, workers=1)
    for number in range(1, 4):
        (traps / f"{number}.fails").touch()
    with pytest.raises(Failure, match="no share came to a result; the first: share 1 of 3: the disk is full"):
        search(squares, tmp_path / "all", shares=3, workers=1)
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs/thesis.txt").write_text("x", encoding="utf-8")
    with pytest.raises(BadInput, match="is not empty and holds no search"):
        search(squares, tmp_path / "theirs")
    with pytest.raises(BadInput, match="a folder of this machine"):
        search(squares, "s3://bucket/out")


PROGRAM_UNDER_TEST = os.environ.get("FRICTIONLAB_BIN")


@pytest.mark.skipif(not PROGRAM_UNDER_TEST, reason="FRICTIONLAB_BIN names no program")
@pytest.mark.parametrize(
    ("asked", "written"),
    [
        (["monte-carlo", "--task", "position-tracking", "--draws", "5", "--means", "feedback,feedforward"], "monte-carlo.json"),
        (["truth-matrix", "--model", "coulomb_viscous,stribeck", "--seeds", "2"], "truth-matrix.json"),
        (["commission", "--trial", "3", "--seed", "5000"], "trial.json"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else None,
)
def test_the_result_is_that_of_one_process_to_the_last_bit(asked, written, tmp_path):
    command = [PROGRAM_UNDER_TEST, *asked]
    alone = subprocess.run([*command, "--out", tmp_path / "alone"], capture_output=True, text=True, check=True)
    found = search(command, tmp_path / "out", shares=3, workers=2)
    assert found.failed == []
    for name in (written, "report.html"):
        if (tmp_path / "alone" / name).exists():
            assert (found.out / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()
    # Beside the table stand the folder and how long it took.
    table = [
        line
        for line in alone.stdout.splitlines()
        if not line.startswith(("Report", "machines    /")) and "a second on" not in line
    ]
    assert table and [line for line in found.text.splitlines() if line in table] == table
