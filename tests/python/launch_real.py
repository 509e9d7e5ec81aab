"""Runs a launch file with the real `launch` and `launch_ros`, where they are installed, and tells what they start.

The programs are replaced: each writes its words and what it was given into a folder, and waits for the end.
"""

import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import yaml

# usage: FILE NAME:=VALUE ...
LAUNCH = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
file, *given = sys.argv[1:]
service = LaunchService(argv=given)
arguments = [tuple(word.split(":=", 1)) for word in given]
service.include_launch_description(
    LaunchDescription([IncludeLaunchDescription(PythonLaunchDescriptionSource(file), launch_arguments=arguments)])
)
sys.exit(service.run())
"""

PROGRAM = """#!{python} -B
import json, os, stat, sys, time
told = {{
    "words": sys.argv,
    "FRICTION_LAUNCHED": os.environ.get("FRICTION_LAUNCHED"),
    "stdin_is_held": stat.S_ISFIFO(os.fstat(0).st_mode) or stat.S_ISSOCK(os.fstat(0).st_mode),
}}
draft = os.path.join({told!r}, f".{{os.getpid()}}")
with open(draft, "w", encoding="utf-8") as file:
    json.dump(told, file)
os.rename(draft, os.path.join({told!r}, f"{{os.getpid()}}.json"))
try:
    time.sleep(60)
except KeyboardInterrupt:
    pass
"""


def installed() -> bool:
    """Whether the real packages are there. PyPI has a `launch` of its own, which is something else."""
    return all(importlib.util.find_spec(name) is not None for name in ("launch", "launch_ros"))


def prefix(folder: Path, package: str, programs: list[str]) -> Path:
    """An installed package with `programs`, as colcon leaves it; they tell into `folder/told`."""
    (folder / "told").mkdir()
    index = folder / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / package).touch()
    (folder / "share" / package).mkdir()
    (folder / "lib" / package).mkdir(parents=True)
    for program in programs:
        file = folder / "lib" / package / program
        file.write_text(PROGRAM.format(python=sys.executable, told=str(folder / "told")), encoding="utf-8")
        file.chmod(0o755)
    return folder


def environment(folder: Path, package: str) -> dict[str, str]:
    """With the package in it, for `launch_ros` and on the PATH."""
    before = os.environ.get("AMENT_PREFIX_PATH")
    return {
        **os.environ,
        "AMENT_PREFIX_PATH": os.pathsep.join(filter(None, [str(folder), before])),
        "PATH": os.pathsep.join([str(folder / "lib" / package), os.environ.get("PATH", "")]),
        "ROS_LOG_DIR": str(folder / "log"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def launch(file: Path, folder: Path, package: str, expected: int, **given: str) -> list[dict]:
    """What the processes tell that the launch file starts, when `expected` of them have."""
    words = [f"{name}:={value}" for name, value in given.items()]
    running = subprocess.Popen(
        [sys.executable, "-c", LAUNCH, str(file), *words],
        env=environment(folder, package),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    until = time.monotonic() + 60
    while len(list((folder / "told").glob("*.json"))) < expected and running.poll() is None and time.monotonic() < until:
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    said, _ = running.communicate(timeout=60)
    told = [json.loads(entry.read_text(encoding="utf-8")) for entry in (folder / "told").glob("*.json")]
    assert len(told) == expected, said
    return told


def meaning(words: list[str]) -> dict:
    """A node's command without the order of its words that means nothing, and with what its parameter files say in place of temporary ones."""
    program, *rest = words
    known: dict = {"program": Path(program).name, "words": [], "remapped": [], "parameters": [], "log_level": None}
    rest = [word for word in rest if word != "--ros-args"]
    while rest:
        word, *rest = rest
        if word in ("-r", "-p", "--params-file", "--log-level"):
            value, *rest = rest
            if word == "-r":
                # The root namespace may be named or left out.
                known["remapped"] = sorted({*known["remapped"], value} - {"__ns:=/"})
            elif word == "--log-level":
                known["log_level"] = value
            elif word == "--params-file" and "launch_params_" in value:
                (inner,) = yaml.safe_load(Path(value).read_text(encoding="utf-8")).values()
                known["parameters"].append(inner["ros__parameters"])
            else:
                known["parameters"].append(value)
        else:
            known["words"].append(word)
    return known
