"""rclpy and the laboratory's messages, imported only by whoever needs them, and a node that spins beside other work."""

from __future__ import annotations

import importlib
import os
import threading
from types import ModuleType, TracebackType
from typing import Any

from friction_analysis.console import AnalysisError


class RosError(AnalysisError):
    """ROS is missing, or does not answer; the text says what to do."""


def load(name: str) -> ModuleType:
    """Imports a module of ROS, as in `load("friction_msgs.msg")`. Raises `RosError` that says where it comes from."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = name.split(".")[0]
        if package == "friction_msgs":
            cure = "build the project's msgs/friction_msgs in a colcon workspace and source its install/setup.bash"
        else:
            cure = "source a ROS 2 installation, as in `source /opt/ros/kilted/setup.bash`, and use the Python it was made for"
        raise RosError(f"{name} cannot be imported ({error}); {cure}") from error


def surroundings() -> str:
    """Where this process looks for others, for messages about nobody being there."""
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    discovery = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    return f"ROS_DOMAIN_ID is {domain} and ROS_AUTOMATIC_DISCOVERY_RANGE {discovery} here: both must fit the other side's"


class SpinningNode:
    """An rclpy node whose callbacks run on a thread of their own while this context manager lasts.

    Signals stay with Python: ctrl-C raises KeyboardInterrupt in the main thread and does not end ROS under our feet.
    """

    def __init__(self, name: str) -> None:
        rclpy = load("rclpy")
        executors = load("rclpy.executors")
        self._context = load("rclpy.context").Context()
        rclpy.init(context=self._context, signal_handler_options=load("rclpy.signals").SignalHandlerOptions.NO)
        self.node: Any = rclpy.create_node(name, context=self._context)
        self._executor = executors.SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        ends = (executors.ExternalShutdownException, executors.ShutdownException)
        self._thread = threading.Thread(target=self._spin, args=(ends,), daemon=True)

    def _spin(self, ends: tuple[type[BaseException], ...]) -> None:
        try:
            self._executor.spin()
        except ends:
            return

    def __enter__(self) -> SpinningNode:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._executor.shutdown(timeout_sec=2.0)
        self._thread.join(timeout=5.0)
        self.node.destroy_node()
        self._context.try_shutdown()
