"""Messages as rows of a table: which columns a type has, and the table of messages that are read one by one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np
import pandas as pd

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


class Rows:
    """The rows of one topic, column by column, from messages that come one by one."""

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
        """Takes in a message, written at this time [ns since the bag's first]."""
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
        """The table."""
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
