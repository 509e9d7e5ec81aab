"""A bag as pandas tables, one for each topic. No ROS is needed: the types are read out of the bag."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag2 import ReaderError
from rosbags.serde import SerdeError
from rosbags.typesys import TypesysError

from friction_analysis.console import AnalysisError
from friction_analysis.topics import topic_name

# Units of the laboratory's messages: field -> column. Fields that are not here keep their name; those of ControllerState
# that are rad or rad/s by mode are among them.
COLUMNS: dict[str, dict[str, str]] = {
    "sensor_msgs/msg/JointState": {"position": "position_rad", "velocity": "velocity_rad_s", "effort": "torque_Nm"},
    "friction_msgs/msg/RigMeasurement": {
        "rig_time": "rig_time_s",
        "encoder_position": "encoder_position_rad",
        "tachometer_velocity": "tachometer_velocity_rad_s",
        "potentiometer_position": "potentiometer_position_rad",
        "torque": "torque_Nm",
        "voltage_asked": "voltage_asked_V",
        "voltage_applied": "voltage_applied_V",
    },
    "friction_msgs/msg/Reference": {
        "position": "position_rad",
        "velocity": "velocity_rad_s",
        "acceleration": "acceleration_rad_s2",
    },
    "friction_msgs/msg/MotorVoltage": {"voltage": "voltage_V"},
    "friction_msgs/msg/FrictionEstimate": {
        "torque": "torque_Nm",
        "deflection": "deflection_rad",
        "gamma": "gamma_Nm",
        "velocity": "velocity_rad_s",
        "residual": "residual_Nm",
    },
    "friction_msgs/msg/ControllerState": {
        "linear": "linear_V",
        "inverse": "inverse_V",
        "friction": "friction_V",
        "dither": "dither_V",
        "total": "total_V",
    },
    "friction_msgs/msg/ExperimentStatus": {"remaining": "remaining_s"},
}

JOINT_STATE = "sensor_msgs/msg/JointState"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"


class BagError(AnalysisError):
    """A bag, or a topic of it, that cannot be read; the text says what was expected."""


@dataclass(frozen=True)
class Bag:
    """Tables of a bag.

    Every table's index is `t_s`, the log time in seconds since `start_ns`; `stamp_ns` is the message's own stamp in
    nanoseconds since 1970, where it has one. Column names carry the unit.
    """

    path: Path
    """The bag folder or .mcap file."""
    start_ns: int
    """Log time of the bag's first message [ns since 1970]: the zero of every index."""
    topics: dict[str, pd.DataFrame] = field(repr=False)
    """Table by topic name; topics without a message have none."""
    types: dict[str, str] = field(repr=False)
    """Message type by topic name."""

    def table(self, name: str, namespace: str = "") -> pd.DataFrame:
        """Table of the topic `namespace`/`name`.

        Raises `BagError`, with the topics that there are, if it was not recorded.
        """
        topic = topic_name(name, namespace)
        try:
            return self.topics[topic]
        except KeyError:
            raise BagError(
                f"{self.path} has no message on {topic}; it has {', '.join(sorted(self.topics)) or 'no topics'}"
            ) from None

    def has(self, name: str, namespace: str = "") -> bool:
        """Whether the topic `namespace`/`name` was recorded."""
        return topic_name(name, namespace) in self.topics


def read_bag(
    bag: Path | str,
    topics: Iterable[str] | None = None,
    start_s: float | None = None,
    stop_s: float | None = None,
) -> Bag:
    """Reads a bag folder or an .mcap file.

    `topics` limits it to these absolute names, `start_s` and `stop_s` to that part of the bag [s since its first message].
    About 40 000 messages a second: name the topics of long bags.

    Raises `BagError` if there is no bag, none of the topics, or a message that does not fit its type.
    """
    path = Path(bag)
    if not path.exists():
        raise BagError(f"{path} does not exist; name a bag folder or an .mcap file")
    wanted = None if topics is None else set(topics)
    try:
        with AnyReader([path]) as reader:
            connections = [c for c in reader.connections if wanted is None or c.topic in wanted]
            if not connections:
                there = ", ".join(sorted({c.topic for c in reader.connections})) or "no topics"
                raise BagError(f"{path} has none of {', '.join(sorted(wanted or ()))}; it has {there}")
            start_ns = int(reader.start_time)
            first = None if start_s is None else start_ns + round(start_s * 1e9)
            last = None if stop_s is None else start_ns + round(stop_s * 1e9)
            tables = {c.topic: _Rows(c.msgtype) for c in connections}
            for connection, log_time, data in reader.messages(connections, start=first, stop=last):
                tables[connection.topic].add(log_time - start_ns, reader.deserialize(data, connection.msgtype))
    except FileNotFoundError as error:
        raise BagError(
            f"{path} has no metadata.yaml: it is no bag, or was cut off while it was written; "
            "`frictionlab bag recover` mends the latter"
        ) from error
    except (AnyReaderError, ReaderError, SerdeError, TypesysError, ValueError, KeyError, IndexError, struct.error) as error:
        # A damaged file can show itself in any of these.
        raise BagError(f"{path} cannot be read as a bag: {error}") from error
    return Bag(
        path=path,
        start_ns=start_ns,
        topics={topic: rows.frame() for topic, rows in tables.items() if rows.times},
        types={topic: rows.type_name for topic, rows in tables.items() if rows.times},
    )


class _Rows:
    """The rows of one topic, column by column."""

    def __init__(self, type_name: str) -> None:
        self.type_name = type_name
        self.times: list[int] = []
        self.columns: dict[str, list[Any]] = {}
        self.units = COLUMNS.get(type_name, {})
        self.flatten: Callable[[Any], dict[str, Any]] = {
            JOINT_STATE: self._joint_state,
            DIAGNOSTICS: _diagnostics,
        }.get(type_name, self._message)

    def add(self, time_ns: int, message: Any) -> None:
        row = self.flatten(message)
        if header := getattr(message, "header", None):
            row["stamp_ns"] = header.stamp.sec * 1_000_000_000 + header.stamp.nanosec
        count = len(self.times)
        for name, value in row.items():
            column = self.columns.setdefault(name, [])
            # A column that comes late has nothing in the rows before.
            column.extend([None] * (count - len(column)))
            column.append(value)
        self.times.append(time_ns)

    def frame(self) -> pd.DataFrame:
        count = len(self.times)
        index = pd.Index(np.asarray(self.times, dtype=np.float64) * 1e-9, name="t_s", dtype=np.float64)
        for column in self.columns.values():
            column.extend([None] * (count - len(column)))
        return pd.DataFrame({name: pd.Series(values, index=index) for name, values in self.columns.items()}, index=index)

    def _message(self, message: Any) -> dict[str, Any]:
        row: dict[str, Any] = {}
        for entry in fields(message):
            name = entry.name
            # Constants of a type are upper case; the header's stamp has a column of its own.
            if name not in ("header", "__msgtype__") and not name.isupper():
                _flatten(self.units.get(name, name), getattr(message, name), row)
        return row

    def _joint_state(self, message: Any) -> dict[str, Any]:
        """One joint has plain columns, as the laboratory's; several have the joint's name before the column."""
        joints = list(message.name)
        return {
            column if len(joints) == 1 else f"{joint}.{column}": values[index]
            for name, column in self.units.items()
            for index, joint in enumerate(joints)
            # Whoever does not measure a quantity leaves its array empty.
            if len(values := getattr(message, name)) == len(joints)
        }


def _flatten(name: str, value: Any, row: dict[str, Any]) -> None:
    """Puts a value into the row: nested messages as name.field, arrays as name[index]."""
    if hasattr(value, "__msgtype__"):
        for entry in fields(value):
            if entry.name != "__msgtype__" and not entry.name.isupper():
                _flatten(f"{name}.{entry.name}", getattr(value, entry.name), row)
    elif isinstance(value, (list, tuple, np.ndarray)):
        for index, item in enumerate(value):
            _flatten(f"{name}[{index}]", item, row)
    else:
        row[name] = value


def _diagnostics(message: Any) -> dict[str, Any]:
    """Every status has its level, and its values by `status/key`; numbers as numbers."""
    row: dict[str, Any] = {}
    for status in message.status:
        level = status.level
        row[f"{status.name}/level"] = level[0] if isinstance(level, (bytes, bytearray)) else level
        row[f"{status.name}/message"] = status.message
        for pair in status.values:
            row[f"{status.name}/{pair.key}"] = _number(pair.value)
    return row


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
