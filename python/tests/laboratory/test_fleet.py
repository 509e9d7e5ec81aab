"""A fleet from end to end on this machine: what is identified, kept, found again, and told."""

import os
import signal
import subprocess
import sys
import time

import frictionlab
import pandas as pd
import pytest
from frictionlab import BadInput

pytest.importorskip("pyarrow")
pytest.importorskip("fsspec")
pytest.importorskip("scipy")

from frictionlab import fleet
from frictionlab.fleet.cli import main
from frictionlab.fleet.dataset import files_for, place
from frictionlab.fleet.trial.made import recording

NAMES = r"(?P<machine>arm[0-9]+)_(?P<time>[0-9-]+)"
MODEL = {"model": "coulomb_viscous"}


@pytest.fixture
def folder(tmp_path):
    """Six machines with ten recordings each; one of them is worn from its seventh recording on."""
    made = tmp_path / "recordings"
    made.mkdir()
    for machine in range(6):
        for day in range(10):
            worn = 0.02 if machine == 3 and day >= 6 else 0.0
            (made / f"arm{machine}_2026-01-{day + 1:02d}.csv").write_bytes(recording(100 * machine + day, 0.1 + worn))
    return made


def parts(out):
    return {file.name: file.read_bytes() for file in sorted((out / "results").iterdir())}


def test_a_fleet_becomes_a_dataset_and_a_page(folder, tmp_path):
    out = tmp_path / "out"
    found = fleet.run(folder, out, names=NAMES, workers=2, **MODEL)
    rows = pd.read_parquet(out / "results")
    assert rows["uri"].nunique() == 60 and rows["error"].isna().all()
    # Each row is what identifying the recording alone gives.
    one = folder / "arm3_2026-01-02.csv"
    alone = frictionlab.identify(one, **MODEL)["coulomb_viscous"]["f_c"]
    row = rows[(rows["uri"] == str(one)) & (rows["parameter"] == "f_c")].iloc[0]
    assert (row["value"], row["standard_error"], row["unit"]) == (alone.value, alone.standard_error, "N m")
    assert (row["low_95"], row["high_95"]) == alone.interval_95
    assert row["machine"] == "arm3" and str(row["time"])[:10] == "2026-01-02"
    joints = found.joints()
    changed = joints[joints["changed"]]
    assert list(changed["machine"]) == ["arm3"] and changed["begins"].iloc[0].endswith("arm3_2026-01-07.csv")
    assert changed["difference_low_95"].iloc[0] < 0.02 < changed["difference_high_95"].iloc[0]
    pooled = found.pooled().set_index("parameter")
    assert pooled.loc["f_v", "low_95"] < 0.04 < pooled.loc["f_v", "high_95"]
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "arm3" in page and "<svg" in page and "src=" not in page and "href=" not in page.replace("xlink:href=", "")
    assert fleet.read(out).to_html() == page


def test_what_is_known_is_not_done_again(folder, tmp_path, monkeypatch):
    out = tmp_path / "out"
    fleet.run(folder, out, names=NAMES, workers=1, **MODEL)
    before, done = parts(out), []
    fleet.run(folder, out, names=NAMES, workers=1, on_progress=lambda count: done.append(count.done), **MODEL)
    assert done == [] and parts(out) == before
    # Another time of change, the same content: it is read and found known. Another content is identified.
    os.utime(folder / "arm0_2026-01-01.csv", (1, 1))
    (folder / "arm1_2026-01-01.csv").write_bytes(recording(7, 0.3))
    found = fleet.run(folder, out, names=NAMES, workers=1, on_progress=lambda count: done.append(count.done), **MODEL)
    assert done == [1, 2]
    rows = found.to_pandas().set_index(["uri", "parameter"])["value"]
    assert rows[(str(folder / "arm1_2026-01-01.csv"), "f_c")] == pytest.approx(0.3, abs=0.01)
    # Other options: all again.
    fleet.run(folder, out, workers=2, model="stribeck", on_progress=lambda count: done.append(count.done))
    assert done[-1] == 60


def test_poisoned_recordings_are_told_and_stop_nothing(folder, tmp_path):
    (folder / "arm9_empty.csv").write_bytes(b"")
    (folder / "arm9_rubbish.parquet").write_bytes(b"PAR1rubbish")
    (folder / "arm9_copy.csv").write_bytes((folder / "arm0_2026-01-01.csv").read_bytes())
    found = fleet.run(folder, tmp_path / "out", workers=2, **MODEL)
    failed = found.failed.set_index("uri")["error"]
    assert len(failed) == 3 and "same, byte for byte" in failed[str(folder / "arm9_copy.csv")]
    assert all(uri in failed[uri] for uri in failed.index if "copy" not in uri)
    assert found.to_pandas().groupby("hash")["uri"].nunique().max() == 2
    rows = found.to_pandas()
    assert rows[rows["error"].isna()].groupby("hash")["uri"].nunique().max() == 1


def test_a_process_that_dies_takes_its_recording_alone_with_it(folder, tmp_path, monkeypatch):
    (folder / "arm9_killer.csv").write_bytes(recording(1))
    site = tmp_path / "site"
    site.mkdir()
    # A reader that ends its process, as one does that runs out of memory.
    (site / "sitecustomize.py").write_text(
        "import sys\n"
        "if any('engines.process' in word for word in sys.orig_argv):\n"
        "    import os, hashlib, frictionlab.fleet.work as work\n"
        "    read = work.content\n"
        "    def content(uri, settings):\n"
        "        if 'killer' in uri: os._exit(9)\n"
        "        return read(uri, settings)\n"
        "    work.content = content\n",
        encoding="utf-8",
    )
    monkeypatch.syspath_prepend(str(site))
    found = fleet.run(folder, tmp_path / "out", workers=2, **MODEL)
    failed = found.failed
    assert len(failed) == 1 and "ended 3 times without a word" in failed["error"].iloc[0]
    assert found.to_pandas()["uri"].nunique() == 61


def test_a_dataset_that_grows_keeps_its_rows(folder, tmp_path, monkeypatch):
    out = tmp_path / "out"
    fleet.run(folder, out, workers=1, **MODEL)
    monkeypatch.setattr("frictionlab.fleet.dataset.EACH", 20)
    (folder / "arm0_2026-02-01.csv").write_bytes(recording(9999))
    done = []
    fleet.run(folder, out, workers=1, on_progress=lambda count: done.append(count.done), **MODEL)
    assert done == [1] and len(parts(out)) == files_for(61) == 4
    fresh = tmp_path / "fresh"
    fleet.run(folder, fresh, workers=2, **MODEL)
    assert parts(out) == parts(fresh)
    assert place("x", 8) == place("x", 16) // 2


def test_a_table_says_what_recordings_are(folder, tmp_path, capsys):
    files = sorted(folder.iterdir())
    table = pd.DataFrame({"uri": map(str, files), "machine": [file.name[:4] for file in files]})
    table["age_h"] = [100.0 * (at % 10) for at in range(len(files))]
    table["temperature_c"] = [20.0 + (at * 7 % 5) for at in range(len(files))]
    table.to_csv(tmp_path / "table.csv", index=False)
    arguments = ["--table", str(tmp_path / "table.csv"), "--out", str(tmp_path / "out"), "--workers", "2", "--quiet"]
    # With the temperature taken out, ten recordings of which four are worn are that sure.
    assert main([*arguments, "--model", "coulomb_viscous", "--false-alarms", "0.05"]) == 0
    said = capsys.readouterr().out
    assert "changed: arm3" in said and "60 recordings, 0 not usable, 1 joint changed" in said
    influences = fleet.read(tmp_path / "out").influences()
    assert set(influences["of"]) == {"temperature", "age"} and (influences["low_95"] < influences["high_95"]).all()
    assert main(["--page-only", "--out", str(tmp_path / "out"), "--false-alarms", "0.02"]) == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes in folders here")
def test_a_pipe_among_recordings_is_not_waited_for(tmp_path):
    made = tmp_path / "recordings"
    made.mkdir()
    (made / "one.csv").write_bytes(recording(1))
    os.mkfifo(made / "two.csv")
    found = fleet.run(made, tmp_path / "out", workers=1, **MODEL)
    assert len(found.failed) == 1 and "is a pipe" in found.failed["error"].iloc[0]
    assert found.to_pandas()["uri"].nunique() == 2


def test_what_a_table_leaves_out_is_left_out(tmp_path):
    file = tmp_path / "one.csv"
    file.write_text("t_s")
    table = pd.DataFrame({"uri": [str(file)], "machine": pd.array([pd.NA], "string"), "age_h": pd.array([pd.NA], "Int64")})
    (found,) = fleet.recordings(table)
    assert (found.machine, found.age_h) == (None, None)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda at: fleet.run(at / "nowhere", at / "out"), "no such file or folder"),
        (lambda at: fleet.run(at, at / "out"), "there is no recording"),
        (lambda at: fleet.run(at / "*.csv", at / "out"), "there is no recording"),
        (lambda at: fleet.run(pd.DataFrame({"path": ["x"]}), at / "out"), "needs the column `uri`"),
        (lambda at: fleet.run(pd.DataFrame({"uri": [3]}), at / "out"), "where an address was expected"),
        (lambda at: fleet.run(pd.DataFrame({"uri": ["x"], "age_h": ["old"]}), at / "out"), "`age_h` must be a number"),
        (lambda at: fleet.run("nothing://x", at / "out"), "nothing"),
        (lambda at: fleet.run(at, at / "out", names="("), "regular expression"),
        (lambda at: fleet.run(at, at / "out", names="(?P<robot>.)"), "named groups among machine"),
        (lambda at: fleet.run(at, at / "out", engine="spark"), "no recording"),
        (lambda at: fleet.run(at, at / "out", longest_s=0.0), "longest time"),
        (lambda at: fleet.run(at, at / "out", validate="x"), "a fleet does not"),
        (lambda at: fleet.read(at), "holds no fleet.json"),
        (lambda at: fleet.pooled([1.0, 2.0], [0.1]), "as many values"),
        (lambda at: fleet.pooled([], []), "no estimate"),
        (lambda at: fleet.pooled([1.0, float("nan")], [0.1, 0.1]), "finite"),
        (lambda at: fleet.changes([1.0] * 9, false_alarms=2.0), "between 0 and 1"),
        (lambda at: fleet.changes([1.0] * 9, [0.1]), "as many values"),
    ],
)
def test_bad_input_is_a_sentence(call, said, tmp_path):
    with pytest.raises(BadInput, match=said):
        call(tmp_path)


def test_a_folder_of_others_is_left_alone(folder, tmp_path):
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs/thesis.txt").write_text("x", encoding="utf-8")
    with pytest.raises(BadInput, match="is not empty and holds no fleet.json"):
        fleet.run(folder, tmp_path / "theirs")
    with pytest.raises(BadInput, match="expected the engine"):
        fleet.run(folder, tmp_path / "out", engine="spark")
    (folder / "arm0_2026-01-01.csv").chmod(0o000)
    if os.geteuid() != 0:
        found = fleet.run(folder, tmp_path / "out", **MODEL)
        assert "not allowed" in found.failed["error"].iloc[0]


def test_the_command_explains_itself_and_names_what_is_wrong(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert "usage: friction-fleet" in said and "  friction-fleet recordings/ --out fleet" in said
    for arguments, text in (
        (["--out", "x"], "expected RECORDINGS or --table"),
        (["x", "--out", "x", "--table", "y"], "one of the two"),
    ):
        assert main(arguments) == 2
        assert text in capsys.readouterr().err


def test_ctrl_c_ends_a_run_and_the_same_command_goes_on(folder, tmp_path):
    for number in range(600):
        (folder / f"more_{number:04d}.csv").write_bytes(recording(5000 + number))
    out = tmp_path / "out"
    command = [sys.executable, "-m", "frictionlab.fleet", str(folder), "--out", str(out), "--workers", "1", "--model", "stribeck"]
    running = subprocess.Popen(command, stderr=subprocess.PIPE)
    try:
        while not list(out.glob("results/*.parquet")):
            assert running.poll() is None
            time.sleep(0.05)
        running.send_signal(signal.SIGINT)
        assert running.wait(timeout=60) == 130
    finally:
        running.kill()
        running.wait()
    assert not list(out.glob("**/.*.parquet.*")), "nothing half-written"
    kept = len(pd.read_parquet(out / "results")["uri"].unique())
    done = []
    found = fleet.run(folder, out, workers=2, model="stribeck", on_progress=lambda count: done.append(count.done))
    assert done[-1] == 660 - kept and found.to_pandas()["uri"].nunique() == 660
