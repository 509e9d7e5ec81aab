import importlib
import subprocess
import sys
from pathlib import Path

import pytest

import friction_analysis

tomllib = pytest.importorskip("tomllib")
PACKAGE = Path(__file__).resolve().parents[1]
SCRIPTS = tomllib.loads((PACKAGE / "pyproject.toml").read_text(encoding="utf-8"))["project"]["scripts"]


def test_what_the_package_offers_can_be_had():
    for name in friction_analysis.__all__:
        assert getattr(friction_analysis, name).__name__ == name
    with pytest.raises(AttributeError, match="has no bad"):
        _ = friction_analysis.bad


# Those of `frictionlab` need the extension module: tests/laboratory.
@pytest.mark.parametrize("script", [name for name, of in SCRIPTS.items() if of.startswith("friction_analysis.")])
def test_every_command_explains_itself_without_ros(script, capsys):
    module, function = SCRIPTS[script].split(":")
    with pytest.raises(SystemExit) as ended:
        getattr(importlib.import_module(module), function)(["--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert f"usage: {script}" in said and f"  {script} " in said, "with an example"


@pytest.mark.parametrize(
    ("module", "without", "said"),
    [
        (["live", "--once", "1", "--out", "x.png"], "rclpy", "source a ROS 2 installation"),
        (["experiment", "all"], "rclpy", "source a ROS 2 installation"),
    ],
)
def test_missing_ros_is_told_with_the_way_to_it(module, without, said):
    # Without: as if it were not installed.
    code = (
        f"import sys; sys.modules[{without!r}] = None; import friction_analysis.{module[0]} as m; sys.exit(m.main({module[1:]}))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=PACKAGE, capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stderr
    assert said in done.stderr and "Traceback" not in done.stderr


def test_experiments_need_neither_pandas_nor_matplotlib():
    code = "import sys, friction_analysis.experiment; print({'pandas', 'matplotlib', 'rclpy'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=PACKAGE, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_wrong_arguments_are_refused_by_name(capsys):
    from friction_analysis import experiment, live

    for main, given, said in (
        (experiment.main, [], "the name of an experiment was expected"),
        (experiment.main, ["all", "--list"], "the name of an experiment was expected"),
        (experiment.main, ["all", "--set", "=3"], "NAME=VALUE was expected"),
        (experiment.main, ["all", "--repetitions", "-1"], "a whole number from 0"),
        (live.main, ["--once", "3"], "--once SECONDS and --out FILE belong together"),
    ):
        with pytest.raises(SystemExit) as ended:
            main(given)
        assert ended.value.code == 2
        assert said in capsys.readouterr().err
