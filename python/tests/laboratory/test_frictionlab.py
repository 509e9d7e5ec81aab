import gc
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import frictionlab
from frictionlab import BadInput

PROGRAM = os.environ.get("FRICTIONLAB_BIN")


def points(noise=0.0):
    """Steady points of a Stribeck curve."""
    v = np.linspace(0.02, 3.0, 60)
    v = np.r_[-v[::-1], v]
    friction = np.sign(v) * (0.1 + 0.03 * np.exp(-((v / 0.15) ** 2))) + 0.04 * v
    return {"velocity_rad_s": v, "torque_Nm": friction + noise * np.random.default_rng(1).standard_normal(len(v))}


def driven(seconds=20.0):
    """An axis that a torque drives: inertia, viscous and Coulomb friction."""
    dt = 1e-3
    t = np.arange(0.0, seconds, dt)
    q = 1.2 * np.sin(2.1 * t) + 0.5 * np.sin(5.3 * t + 0.4)
    v = 1.2 * 2.1 * np.cos(2.1 * t) + 0.5 * 5.3 * np.cos(5.3 * t + 0.4)
    a = -1.2 * 2.1**2 * np.sin(2.1 * t) - 0.5 * 5.3**2 * np.sin(5.3 * t + 0.4)
    noise = 0.002 * np.random.default_rng(2).standard_normal(len(t))
    return {"t_s": t, "position_rad": q, "torque_Nm": 0.02 * a + 0.05 * v + 0.1 * np.sign(v) + noise}


def test_every_model_is_listed_with_units_and_has_a_friction():
    for info in frictionlab.models():
        model = frictionlab.Model(info.name)
        assert model.info == info and model.title == info.title
        assert all(row.meaning and row.range for row in info.parameters)
        assert model.force([0.3] * 5, 1e-3).shape == (5,)
    lugre = {row.name: row for row in frictionlab.Model("lugre").info.parameters}
    assert (lugre["sigma0"].unit_rotary, lugre["sigma0"].unit_linear) == ("N m/rad", "N/m")


def test_a_model_stepped_by_hand_is_the_same_model():
    model = frictionlab.Model("proposed")
    v = 0.3 * np.sin(np.linspace(0.0, 9.0, 500))
    contact = model.contact(1e-3)
    stepped = [contact.step(float(x)) for x in v]
    assert np.array_equal(stepped, model.force(v, 1e-3, scheme="held"))
    contact.reset()
    assert contact.step(float(v[0])) == stepped[0]


def test_a_sweep_has_a_row_for_each_set():
    model = frictionlab.Model("gms")
    v = 0.3 * np.sin(np.linspace(0.0, 9.0, 200))
    sets = {"f_c": np.linspace(0.05, 0.09, 7), "f_v": np.linspace(0.0, 0.1, 7)}
    found = model.sweep(sets, v, 1e-3)
    assert found.shape == (7, 200) and np.array_equal(found, model.sweep(sets, v, 1e-3, jobs=1))
    third = frictionlab.Model("gms", f_c=sets["f_c"][2], f_v=sets["f_v"][2])
    assert np.allclose(found[2], third.force(v, 1e-3), rtol=0.0, atol=1e-14)
    assert model.sweep({}, v, 1e-3).shape == (0, 200)


def test_a_model_goes_through_its_parameter_file():
    model = frictionlab.Model("gms", preset="chapter-3")
    assert frictionlab.Model.from_yaml(model.to_yaml()).parameters == model.parameters
    assert "f_c" in frictionlab.Model("lugre").to_pandas().index
    assert "LuGre" in frictionlab.Model("lugre")._repr_html_()


def test_arrays_of_every_kind_are_the_same_numbers():
    model = frictionlab.Model("lugre")
    v = 0.3 * np.sin(np.linspace(0.0, 9.0, 500))
    expected = model.force(v, 1e-3)
    strided = np.repeat(v, 3)[::3]
    fixed = v.copy()
    fixed.flags.writeable = False
    for given in (v.tolist(), strided, fixed, pd.Series(v), v.astype(">f8"), np.asfortranarray(v)):
        assert np.array_equal(model.force(given, 1e-3), expected)


@pytest.mark.skipif(PROGRAM is None, reason="FRICTIONLAB_BIN names no program")
def test_arrays_a_dataframe_and_files_give_what_the_command_gives(tmp_path):
    table = pd.DataFrame(points(1e-4))
    csv, npz, out = tmp_path / "points.csv", tmp_path / "points.npz", tmp_path / "out"
    table.to_csv(csv, index=False)
    np.savez(npz, **points(1e-4))
    command = [PROGRAM, "identify", str(csv), "--model", "stribeck,coulomb_viscous", "--out", str(out), "--quiet"]
    subprocess.run(command, check=True)
    kept = {"models", "ranking", "warnings", "notes"}
    from_csv = frictionlab.identify(csv, model=["stribeck", "coulomb_viscous"])
    assert (out / "identification.json").read_text() == from_csv._found.json()
    assert (out / "parameters.yaml").read_text() == from_csv.to_yaml()
    assert (out / "report.html").read_text() == from_csv.to_html()
    folder = from_csv.save(tmp_path / "saved")
    assert (Path(folder) / "parameters.yaml").read_text() == from_csv.to_yaml()
    with pytest.raises(BadInput, match="not empty"):
        from_csv.save(tmp_path / "saved")
    for data in (points(1e-4), table, npz, [npz]):
        found = frictionlab.identify(data, model=["stribeck", "coulomb_viscous"])
        assert {key: found.document[key] for key in kept} == {key: from_csv.document[key] for key in kept}


@pytest.mark.skipif(PROGRAM is None, reason="FRICTIONLAB_BIN names no program")
def test_a_driven_axis_gives_what_the_command_gives(tmp_path):
    csv, out = tmp_path / "axis.csv", tmp_path / "out"
    pd.DataFrame(driven()).to_csv(csv, index=False)
    subprocess.run([PROGRAM, "identify", str(csv), "--out", str(out), "--quiet"], check=True)
    found = frictionlab.identify(csv)
    assert (out / "identification.json").read_text() == found._found.json()
    assert (out / "parameters.yaml").read_text() == found.to_yaml()
    held = frictionlab.identify(driven(), validate=driven(10.0))
    assert held["symmetric"].parameters == found["symmetric"].parameters
    assert held["symmetric"].held_out is not None
    assert found["symmetric"]["inertia"].value == pytest.approx(0.02, rel=0.02)
    assert found.kind == "axis" and found.chosen is None
    found.plot()


def test_a_bag_is_read_as_the_command_reads_it():
    bag = os.environ.get("FRICTION_TEST_BAG")
    if bag is None:
        pytest.skip("FRICTION_TEST_BAG names no bag")
    found = frictionlab.identify(bag, model="coulomb_viscous")
    assert found["coulomb_viscous"]["f_c"].value > 0.0


def test_a_result_shows_values_errors_intervals_and_verdicts():
    found = frictionlab.identify(points(1e-3), model="stribeck")
    estimate = found["stribeck"]["f_c"]
    low, high = estimate.interval_95
    assert low < estimate.value < high and estimate.standard_error > 0.0 and estimate.unit == "N m"
    assert estimate.identified and abs(float(estimate) - 0.1) < 0.01
    rows = found.to_pandas()
    assert rows.loc[("stribeck", "f_c"), "value"] == estimate.value
    assert "stribeck" in found._repr_html_() and "stribeck" in str(found) and "<html" in found.to_html()
    assert len(found.plot().axes) == 1
    model = found.model("stribeck")
    assert model["f_c"] == pytest.approx(estimate.value)
    assert model.steady_state(2.0) == pytest.approx(0.18, rel=0.02)


def test_a_simulation_is_a_table():
    t = np.linspace(0.0, 1.0, 101)
    found = frictionlab.simulate("lugre", {"t_s": t, "velocity_rad_s": 0.3 * np.sin(6.0 * t)}, dt=1e-3)
    assert np.array_equal(found.time, t) and found.to_pandas().shape == (101, 7)
    assert set(found.to_pandas()["regime"]) <= {"stick", "slip"}
    linear = frictionlab.simulate("coulomb", pd.DataFrame({"t_s": t, "velocity_m_s": np.ones(101)}), dt=1e-3)
    assert np.all(linear.friction == linear.model["f_c"])
    assert len(found.plot().axes) == 2


def test_features_and_designs_are_those_of_the_command():
    found = frictionlab.features("coulomb_viscous")
    assert found.document["models"] and "<html" in found.to_html()
    gains = frictionlab.design("velocity", crossover=150, phase_margin=60)
    assert set(gains.gains) == {"k_p", "k_i"} and "controller" in gains.to_yaml()
    assert not gains.to_pandas().empty and gains.remarks


def closed():
    file = Path(__file__).open()  # noqa: SIM115
    file.close()
    return file


NUMBERS = {"t_s": np.arange(50) * 1e-3, "velocity_rad_s": np.ones(50)}


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: frictionlab.Model("lugr"), "did you mean `lugre`"),
        (lambda: frictionlab.Model("lugre", preset="mine"), "expected one of the sets"),
        (lambda: frictionlab.Model("lugre", f_s=-1), "above zero"),
        (lambda: frictionlab.Model("lugre", f_s=float("nan")), "f_s"),
        (lambda: frictionlab.Model("lugre", f_s=[1, 2]), "f_s"),
        (lambda: frictionlab.Model("lugre", nonsense=1), "unknown field `nonsense`"),
        (lambda: frictionlab.Model.from_yaml("a: [b"), "."),
        (lambda: frictionlab.Model("lugre").force([0.1, float("nan")], 1e-3), "finite number"),
        (lambda: frictionlab.Model("lugre").force([0.1], 1.0), "fixed step"),
        (lambda: frictionlab.Model("lugre").force([0.1], 1e-3, scheme="x"), "`mean` or `held`"),
        (lambda: frictionlab.Model("lugre").force(["a"], 1e-3), "must hold numbers"),
        (lambda: frictionlab.Model("lugre").force([[1.0]], 1e-3), "dimension"),
        (lambda: frictionlab.Model("lugre").force([1.0, [2.0]], 1e-3), "array of numbers"),
        (lambda: frictionlab.Model("lugre").sweep({"f_x": [1.0]}, [0.1], 1e-3), "no parameter `f_x`"),
        (lambda: frictionlab.Model("lugre").sweep({"f_c": [0.09, -1.0]}, [0.1], 1e-3), "parameter set 1"),
        (lambda: frictionlab.Model("lugre").sweep({"f_c": [0.09], "f_v": []}, [0.1], 1e-3), "`f_v` has 0"),
        (lambda: frictionlab.identify("none.csv"), "No such file"),
        (lambda: frictionlab.identify("s3://bucket/x.csv"), "got the address s3://bucket/x.csv"),
        (lambda: frictionlab.identify({"velocity_furlong": np.ones(50), "torque_Nm": np.ones(50)}), "velocity_furlong"),
        (lambda: frictionlab.identify(closed()), "closed file"),
        (lambda: frictionlab.identify(3), "files, DataFrames or arrays"),
        (lambda: frictionlab.identify([3]), "got int"),
        (lambda: frictionlab.identify([]), "required arguments"),
        (lambda: frictionlab.identify({}), "no array"),
        (lambda: frictionlab.identify({"t_s": [0.0, 1.0], "position_rad": [1.0]}), "has 2 values"),
        (lambda: frictionlab.identify({"velocity_rad_s": np.array([1, "a"], dtype=object)}), "must hold numbers"),
        (lambda: frictionlab.identify({"velocity_rad_s": [1j] * 9, "torque_Nm": [1.0] * 9}), "complex"),
        (lambda: frictionlab.identify({3: [1.0]}), "must be called by a text"),
        (lambda: frictionlab.identify({"velocity_rad_s": [np.nan] * 9, "torque_Nm": [1.0] * 9}), "no value"),
        (lambda: frictionlab.identify({"velocity_rad_s": [np.inf] * 9, "torque_Nm": [1.0] * 9}), "inf"),
        (lambda: frictionlab.identify({"t_s": [0, 1, 2], "q_ells": [0, 1, 2]}), "recognised"),
        (lambda: frictionlab.identify(points(), model="karnopp"), "cannot be identified"),
        (lambda: frictionlab.identify(points(), inertia="heavy", model="lugre"), "expected an inertia"),
        (lambda: frictionlab.identify(points(), nonsense=3), "unexpected argument '--nonsense'"),
        (lambda: frictionlab.identify(points(), out="here"), "option of the command"),
        (lambda: frictionlab.identify(points(), cutoff=-3.0, model="stribeck"), "--cutoff"),
        (lambda: frictionlab.identify(driven()).model(), "holds no friction model"),
        (lambda: frictionlab.simulate("lugre", NUMBERS, dt=0.0), "--dt must be"),
        (lambda: frictionlab.simulate("lugre", NUMBERS, scheme="euler"), "`mean`, `held` or `rk4`"),
        (lambda: frictionlab.simulate("lugre", NUMBERS, load_gain=1.0), "load"),
        (lambda: frictionlab.simulate("lugre", NUMBERS | {"t_s": np.zeros(50)}), "<motion>"),
        (lambda: frictionlab.simulate("lugre", NUMBERS | {"velocity_rad_s": np.full(50, np.nan)}), "NaN"),
        (lambda: frictionlab.simulate("lugre", NUMBERS | {"velocity_rad_s": np.full(50, 1e9)}), "at most 1e6"),
        (lambda: frictionlab.features("lugr"), "did you mean"),
        (lambda: frictionlab.design("velocity"), "expected one of"),
        (lambda: frictionlab.design("position", gains=[1, 2]), "three numbers"),
    ],
)
def test_bad_input_is_an_exception_with_a_sentence(call, said):
    with pytest.raises(BadInput, match=said) as raised:
        call()
    assert isinstance(raised.value, ValueError) and "panic" not in str(raised.value)


def test_a_wrong_type_is_an_exception_and_no_panic():
    from frictionlab import _native

    for call in (lambda: _native.features([], 0), lambda: _native.identify(["--x"], [], []), lambda: _native.design([])):
        with pytest.raises((BadInput, TypeError, ValueError, OverflowError)):
            call()


LONG = """
import sys, frictionlab
print("begun", flush=True)
while True:
    frictionlab.features()
"""

FIT = """
import numpy as np, frictionlab
rng = np.random.default_rng(1)
t = np.arange(0.0, 60.0, 1e-3)
v = 0.4 * np.sin(3.1 * t) + 0.2 * np.sin(11.3 * t)
friction = frictionlab.Model("lugre").force(v, 1e-3) + 1e-3 * rng.standard_normal(len(t))
print("begun", flush=True)
while True:
    frictionlab.identify({"t_s": t, "velocity_rad_s": v, "torque_Nm": friction}, model="all", inertia="0.0026:0.00003")
"""


@pytest.mark.parametrize("program", [LONG, FIT])
def test_an_interrupt_ends_a_call(program):
    # Whoever runs the tests in the background of a shell hands down that ctrl-C is ignored.
    heeded = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n" + program
    with subprocess.Popen([sys.executable, "-c", heeded], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        try:
            assert running.stdout.readline() == "begun\n"
            running.send_signal(signal.SIGINT)
            _, said = running.communicate(timeout=60)
        finally:
            running.kill()
    assert said.rstrip().endswith("KeyboardInterrupt"), said
    assert running.returncode == -signal.SIGINT


def test_other_threads_go_on_while_it_computes():
    counted = [0]
    ended = threading.Event()

    def count():
        while not ended.is_set():
            counted[0] += 1
            time.sleep(1e-4)

    other = threading.Thread(target=count)
    other.start()
    before = counted[0]
    frictionlab.features("lugre", jobs=1)
    ended.set()
    other.join()
    assert counted[0] > before + 10


def test_calls_from_several_threads_agree():
    v = 0.3 * np.sin(np.linspace(0.0, 50.0, 20_000))
    model, results = frictionlab.Model("gms"), []
    threads = [threading.Thread(target=lambda: results.append(model.force(v, 1e-3))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    gc.collect()
    assert len(results) == 4 and all(np.array_equal(result, results[0]) for result in results)


def test_what_was_identified_is_exported(tmp_path):
    found = frictionlab.identify(points(1e-4), model="coulomb_viscous,stribeck")
    urdf = found.export("urdf", joint="elbow", model="stribeck", accept_unidentified=True)
    assert "<dynamics" in urdf.text and "elbow" in str(urdf) and urdf.version == "1.2"
    assert 0.0 < urdf.sliding_error < 10.0 and urdf.lost
    assert "0.02 to 3 rad/s, the speeds of the recordings" in urdf.text
    header = found.export("c_header", model="stribeck", accept_unidentified=True)
    assert header.sliding_error == 0.0 and not header.lost and "friction_step" in header.text
    file = header.save(tmp_path / "friction.h")
    assert file.read_text() == header.text
    with pytest.raises(BadInput, match="force=True"):
        header.save(file)
    with pytest.raises(BadInput, match="cannot be written"):
        header.save(tmp_path / "nowhere" / "friction.h")
    older = found.export("mjcf", version="3.6", model="coulomb_viscous")
    assert "frictionloss" in older.text and "dcmotor" not in older.text


def test_an_export_that_cannot_be_is_refused_in_a_sentence():
    found = frictionlab.identify(points(1e-4), model="coulomb_viscous")
    for target, options, said in (
        ("gazebo_3", {}, "expected one of mjcf"),
        ("mjcf", {"version": "9"}, "known are 2.0 to 4.0"),
        ("mjcf", {"model": "lugre"}, "no parameters of `lugre`"),
        ("isaac_lab", {"version": "2.1"}, "coefficient"),
        ("ur", {}, "--reference"),
        ("urdf", {"out": "a.urdf"}, "save"),
        ("urdf", {"joint": "a b"}, "letters"),
        ("urdf", {"speeds": "3:1"}, "LOW to HIGH"),
    ):
        with pytest.raises(BadInput, match=said):
            found.export(target, **options)


def test_a_recording_that_names_no_joints_is_its_one_joint(tmp_path):
    v = np.linspace(0.05, 3.0, 40)
    given = {"velocity_rad_s": np.r_[-v, v], "torque_Nm": np.r_[-0.1 - 0.04 * v, 0.1 + 0.04 * v]}
    alone = frictionlab.identify(given, model="coulomb_viscous")
    several = frictionlab.identify_joints(given, model="coulomb_viscous")
    assert list(several) == [""] and several[""].document == alone.document
    assert frictionlab.identify(given, model="coulomb_viscous", joint="all").document == alone.document
    if PROGRAM:
        file = tmp_path / "points.csv"
        rows = zip(given["velocity_rad_s"], given["torque_Nm"], strict=True)
        file.write_text("velocity_rad_s,torque_Nm\n" + "".join(f"{speed},{torque}\n" for speed, torque in rows))
        command = [PROGRAM, "identify", file, "--model", "coulomb_viscous", "--joint", "all", "--json", "--out", tmp_path / "out"]
        told = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
        value = told["models"]["coulomb_viscous"]["parameters"]["f_c"]["value"]
        assert value == alone["coulomb_viscous"]["f_c"].value


def test_several_joints_give_a_result_each():
    v = np.r_[-np.linspace(0.05, 3.0, 30), np.linspace(0.05, 3.0, 30)]
    torque = np.sign(v) * 0.1 + 0.04 * v
    given = {"velocity_rad_s": np.c_[v, v, v], "torque_Nm": np.c_[torque, 2.0 * torque, np.full_like(v, np.nan)]}
    found = frictionlab.identify_joints(given, model="coulomb_viscous")
    names = list(found)
    assert len(names) == 2 and len(found.failed) == 1, (names, found.failed)
    assert [round(one["coulomb_viscous"]["f_c"].value, 6) for one in found.values()] == [0.1, 0.2]
    assert found.to_pandas().index.names == ["joint", "model", "parameter"]
    # The same as alone, and one of a list.
    alone = frictionlab.identify(given, model="coulomb_viscous", joint=names[1])
    assert alone.document == found[names[1]].document
    assert list(frictionlab.identify_joints(given, [names[1]], model="coulomb_viscous")) == [names[1]]
    with pytest.raises(frictionlab.BadInput, match="identify_joints"):
        frictionlab.identify(given, model="coulomb_viscous", joint="all")
    with pytest.raises(frictionlab.BadInput, match="its joints are"):
        frictionlab.identify_joints(given, "elbow,wrist", model="coulomb_viscous")


def _stribeck(seed, f_v=0.04):
    random = np.random.default_rng(seed)
    v = np.r_[-np.geomspace(0.01, 3.0, 60), np.geomspace(0.01, 3.0, 60)]
    torque = np.sign(v) * (0.1 + 0.05 * np.exp(-((v / 0.2) ** 2))) + f_v * v
    points = {"velocity_rad_s": v, "torque_Nm": torque + 0.001 * random.standard_normal(v.size)}
    return frictionlab.identify(points, model="stribeck")


def test_samples_have_the_covariance_of_the_fit():
    found = _stribeck(1)
    drawn = found.samples(20_000, seed=4)
    assert drawn.equals(found.samples(20_000, seed=4)) and not drawn.equals(found.samples(20_000, seed=5))
    covariance = found.covariance()
    names = list(covariance.columns)
    errors = np.sqrt(np.diag(covariance))
    assert np.allclose(errors, [found["stribeck"][name].standard_error for name in names])
    correlation = covariance.to_numpy() / np.outer(errors, errors)
    assert np.allclose(np.corrcoef(drawn[names].to_numpy().T), correlation, atol=0.06)
    for name in names:
        low, high = found["stribeck"][name].interval_95
        assert abs(np.mean((drawn[name] > low) & (drawn[name] < high)) - 0.95) < 0.01
        assert abs(np.median(drawn[name]) / found["stribeck"][name].value - 1.0) < 0.01
    assert drawn.attrs["units"]["f_v"]
    with pytest.raises(frictionlab.BadInput, match="number of samples"):
        found.samples(0)
    with pytest.raises(frictionlab.BadInput, match="expected csv, mjlab or isaac_lab"):
        found.randomisation("gazebo")


@pytest.mark.parametrize("target", ["mjlab", "isaac_lab"])
def test_event_terms_are_python_with_a_table_of_sets(target):
    text = _stribeck(1).randomisation(target, 50, joint="elbow")
    compile(text, target, "exec")
    table = text[text.index("ELBOW_FRICTION = (") : text.index("\n)\n") + 3]
    scope = {}
    exec(table, scope)
    rows = np.array(scope["ELBOW_FRICTION"])
    assert rows.shape == (50, 2 if target == "mjlab" else 3) and (rows > 0.0).all()


def test_two_identifications_are_compared(tmp_path):
    one, same, other = _stribeck(1), _stribeck(2), _stribeck(3, f_v=0.044)
    assert not frictionlab.compare(one, same)
    found = frictionlab.compare(one, other)
    assert found.differ and found.answer.startswith("They differ") and found.answer in str(found)
    assert bool(found.parameters.loc["f_v", "differs"]) and found.torque["differs"].any()
    folder = tmp_path / "saved"
    one.save(folder)
    assert frictionlab.compare(folder, other).document["parameters"] == found.document["parameters"]
    with pytest.raises(frictionlab.BadInput, match="nowhere"):
        frictionlab.compare(tmp_path / "nowhere", one)


def test_axes_have_samples_a_covariance_and_a_comparison():
    found = frictionlab.identify(driven())
    matrix = found.covariance()
    assert list(matrix.columns) == ["inertia", "viscous", "coulomb", "offset"]
    assert matrix.loc["coulomb", "coulomb"] == pytest.approx(found["symmetric"]["coulomb"].standard_error ** 2)
    assert matrix.loc["viscous", "coulomb"] < 0.0, "more of one is less of the other"
    drawn, both = found.samples(20_000, seed=1), ["viscous", "coulomb"]
    assert np.allclose(drawn[both].cov(), matrix.loc[both, both], rtol=0.25)
    assert "ELBOW_FRICTION" in found.randomisation("mjlab", 100, joint="elbow")
    assert not frictionlab.compare(found, frictionlab.identify(driven(19.0))).differ
    worn = driven()
    worn["torque_Nm"] = worn["torque_Nm"] + 0.02 * np.sign(np.gradient(worn["position_rad"]))
    told = frictionlab.compare(found, frictionlab.identify(worn))
    assert told.differ and "coulomb" in told.answer
