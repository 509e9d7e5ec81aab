import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_the_examples_in_the_documentation_are_true():
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--doctest-modules", "frictionlab"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_the_types_hold_and_the_stubs_have_what_is_there(tmp_path):
    pytest.importorskip("mypy")
    from frictionlab import _native

    stub = (ROOT / "frictionlab/_native.pyi").read_text(encoding="utf-8")
    for name in dir(_native):
        if not name.startswith("__"):
            assert f"class {name}" in stub or f"def {name}" in stub, name
            for member in dir(getattr(_native, name)):
                assert member.startswith("_") or f"def {member}(" in stub, f"{name}.{member}"
    script = tmp_path / "caller.py"
    script.write_text(
        "import frictionlab\n"
        "found = frictionlab.identify({'velocity_rad_s': [1.0], 'torque_Nm': [1.0]}, model='lugre')\n"
        "value: float = found['lugre']['f_c'].value\n"
        "forces = frictionlab.Model('lugre').force([0.1], 1e-3)\n"
        "total: float = float(forces.sum())\n",
        encoding="utf-8",
    )
    for checked in (["-p", "frictionlab"], [str(script)]):
        command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), *checked]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout


def test_the_notebook_runs():
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    notebook = nbformat.read(ROOT / "notebooks/tutorial.ipynb", as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "it is kept without outputs"
    client = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(ROOT)}})
    client.execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in shown)
    assert not [output for output in shown if output["output_type"] == "error"]
    assert json.dumps(notebook)
