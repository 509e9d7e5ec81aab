"""Stands in for the Python packages `launch` and `launch_ros`, which PyPI does not have: runs launch files and writes down what they would start.

It has what this project's launch files use and refuses everything else, by the signatures of ROS 2 Kilted. Where the real packages are installed, `launch_real.py`
compares it with them.
"""

from __future__ import annotations

import importlib.util
import json
import os
import sys
import tempfile
import types
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


class LaunchContext:
    """Launch configurations, and what was started."""

    def __init__(self, given: dict[str, str]) -> None:
        self.launch_configurations = dict(given)
        self.declared: dict[str, DeclareLaunchArgument] = {}
        self.started: list[ExecuteProcess] = []


@dataclass
class LaunchConfiguration:
    variable_name: str

    def perform(self, context: LaunchContext) -> str:
        if self.variable_name not in context.launch_configurations:
            raise KeyError(f"launch configuration '{self.variable_name}' does not exist")
        return context.launch_configurations[self.variable_name]


def text(value: Any, context: LaunchContext) -> str:
    """What launch makes of text and substitutions; numbers and None are mistakes there."""
    if isinstance(value, LaunchConfiguration):
        return value.perform(context)
    assert isinstance(value, str), f"text or a substitution was expected, but {value!r} came"
    return value


@dataclass
class DeclareLaunchArgument:
    name: str
    default_value: Any = None
    description: str = ""

    def execute(self, context: LaunchContext) -> None:
        context.declared.setdefault(self.name, self)
        if self.name not in context.launch_configurations:
            if self.default_value is None:
                raise RuntimeError(f"argument {self.name} has no default and was not given")
            context.launch_configurations[self.name] = text(self.default_value, context)


@dataclass
class Shutdown:
    reason: str = ""


@dataclass(kw_only=True)
class ExecuteProcess:
    cmd: list[Any] = field(default_factory=list)
    name: str | None = None
    output: str = "log"
    sigterm_timeout: str = "5"
    on_exit: Any = None
    additional_env: dict[str, str] = field(default_factory=dict)

    def execute(self, context: LaunchContext) -> None:
        self.cmd = [text(part, context) for part in self.cmd]
        assert self.cmd or isinstance(self, Node)
        assert isinstance(self.sigterm_timeout, str), "launch wants text"
        assert all(isinstance(part, str) for pair in self.additional_env.items() for part in pair), "launch wants text"
        context.started.append(self)


@dataclass(kw_only=True)
class Node(ExecuteProcess):
    executable: str
    package: str
    namespace: str = ""
    parameters: list[Any] = field(default_factory=list)
    remappings: list[tuple[str, str]] = field(default_factory=list)
    arguments: list[str] = field(default_factory=list)

    def execute(self, context: LaunchContext) -> None:
        for parameter in self.parameters:
            assert isinstance(parameter, (str, dict)), parameter
        super().execute(context)

    def program(self) -> Path:
        """The file that `ros2 run` and `launch_ros` find for a package's executable."""
        for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
            if prefix and (Path(prefix) / "share/ament_index/resource_index/packages" / self.package).exists():
                file = Path(prefix) / "lib" / self.package / self.executable
                if not os.access(file, os.X_OK):
                    raise RuntimeError(f"executable '{self.executable}' not found on the libexec directory '{file.parent}'")
                return file
        raise RuntimeError(f"package '{self.package}' not found, searching: {os.environ.get('AMENT_PREFIX_PATH', '')}")

    def command(self) -> list[str]:
        """The words that `launch_ros` starts it with. Parameters that are not in a file go into one of their own."""
        words = [str(self.program()), *self.arguments, "--ros-args", "-r", f"__node:={self.name}"]
        if self.namespace:
            words += ["-r", f"__ns:=/{self.namespace.strip('/')}"]
        for parameter in self.parameters:
            if isinstance(parameter, dict):
                with tempfile.NamedTemporaryFile("w", prefix="launch_params_", suffix=".yaml", delete=False) as file:
                    # What YAML has of JSON is enough for it.
                    json.dump({"/**": {"ros__parameters": parameter}}, file)
                parameter = file.name
            words += ["--params-file", parameter]
        for before, after in self.remappings:
            words += ["-r", f"{before}:={after}"]
        return words


@dataclass(kw_only=True)
class OpaqueFunction:
    function: Callable[[LaunchContext], Iterable[Any] | None]

    def execute(self, context: LaunchContext) -> None:
        run(self.function(context) or [], context)


@dataclass
class PythonLaunchDescriptionSource:
    location: str


@dataclass
class IncludeLaunchDescription:
    source: PythonLaunchDescriptionSource
    launch_arguments: Iterable[tuple[str, Any]] = ()

    def execute(self, context: LaunchContext) -> None:
        for name, value in self.launch_arguments:
            context.launch_configurations[name] = text(value, context)
        run(load(Path(self.source.location)).generate_launch_description().entities, context)


@dataclass
class LaunchDescription:
    entities: list[Any]


def run(entities: Iterable[Any], context: LaunchContext) -> None:
    for entity in entities:
        entity.execute(context)


PACKAGES: dict[str, tuple[type, ...]] = {
    "launch": (LaunchContext, LaunchDescription),
    "launch.actions": (DeclareLaunchArgument, ExecuteProcess, IncludeLaunchDescription, OpaqueFunction, Shutdown),
    "launch.substitutions": (LaunchConfiguration,),
    "launch.launch_description_sources": (PythonLaunchDescriptionSource,),
    "launch_ros": (),
    "launch_ros.actions": (Node,),
}


def load(file: Path) -> Any:
    """Imports a launch file with the stand-ins in place of ROS's packages."""
    before = {name: sys.modules.get(name) for name in PACKAGES}
    for name, classes in PACKAGES.items():
        module = types.ModuleType(name)
        for entry in classes:
            setattr(module, entry.__name__, entry)
        sys.modules[name] = module
    try:
        spec = importlib.util.spec_from_file_location(file.name.replace(".", "_"), file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    finally:
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module


def launch(file: Path, **given: str) -> LaunchContext:
    """Runs a launch file as `ros2 launch FILE name:=value ...` would, and returns what it declared and started."""
    context = LaunchContext(given)
    run(load(file).generate_launch_description().entities, context)
    return context
