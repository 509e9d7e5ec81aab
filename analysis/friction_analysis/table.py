"""A bag as a table: one row a sample time, one column a quantity, units in the column names.

usage: friction-table BAG TABLE.csv
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader, AnyReaderError
from rosbags.rosbag2 import ReaderError

Row = dict[str, float]

# Column names and how they are found in a message of the topic. Torque is friction torque, positive against positive
# velocity.
COLUMNS: dict[str, dict[str, Callable[[Any], float]]] = {
    "/joint_states": {
        "position_rad": lambda m: m.position[0],
        "velocity_rad_s": lambda m: m.velocity[0],
        "torque_Nm": lambda m: m.effort[0],
    },
    "/motor_voltage": {"voltage_V": lambda m: m.voltage},
    "/friction_estimate": {
        "estimated_torque_Nm": lambda m: m.torque,
        "deflection_rad": lambda m: m.deflection,
        "gamma_Nm": lambda m: m.gamma,
    },
    "/reference": {
        "reference_position_rad": lambda m: m.position,
        "reference_velocity_rad_s": lambda m: m.velocity,
    },
    "/controller_state": {"error": lambda m: m.error, "friction_voltage_V": lambda m: m.friction},
}


class BagError(Exception):
    """A bag that cannot be turned into a table; the text says what was expected."""


def read_table(bag: Path) -> dict[str, list[float]]:
    """Columns of the bag by name, `t_s` (seconds since the first sample) first, all of one length.

    A quantity that was not recorded at a time is not a number there; one that the bag does not have gets no column.
    """
    if not bag.exists():
        raise BagError(f"{bag} does not exist; name a bag folder or an .mcap file")
    rows: dict[int, Row] = {}
    names: list[str] = []
    try:
        with AnyReader([bag]) as reader:
            connections = [c for c in reader.connections if c.topic in COLUMNS]
            for connection in connections:
                names.extend(name for name in COLUMNS[connection.topic] if name not in names)
            for connection, stamp, data in reader.messages(connections):
                message = reader.deserialize(data, connection.msgtype)
                row = rows.setdefault(stamp, {})
                for name, read in COLUMNS[connection.topic].items():
                    row[name] = float(read(message))
    except (AnyReaderError, ReaderError) as error:
        raise BagError(f"{bag} cannot be read as a bag: {error}") from error
    except IndexError as error:
        raise BagError(f"{bag} has joint states without a joint; expected position, velocity and effort") from error
    if not rows:
        raise BagError(f"{bag} has no message on any of {', '.join(COLUMNS)}")
    ordered = [name for columns in COLUMNS.values() for name in columns if name in names]
    stamps = sorted(rows)
    table = {"t_s": [(stamp - stamps[0]) * 1e-9 for stamp in stamps]}
    for name in ordered:
        table[name] = [rows[stamp].get(name, math.nan) for stamp in stamps]
    return table


def write_csv(table: dict[str, list[float]], file: Path) -> None:
    """Writes the columns as CSV. What is not a number is left empty; times are rounded to the nanosecond they have."""

    def cell(name: str, value: float) -> str:
        if math.isnan(value):
            return ""
        return repr(round(value, 9)) if name == "t_s" else repr(value)

    with file.open("w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(table)
        names = list(table)
        for values in zip(*table.values(), strict=True):
            writer.writerow([cell(name, value) for name, value in zip(names, values, strict=True)])


def main() -> int:
    """The command `friction-table`."""
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    bag, file = map(Path, sys.argv[1:])
    try:
        table = read_table(bag)
        write_csv(table, file)
    except (BagError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{file}: {len(table['t_s'])} rows, {len(table)} columns")
    return 0


if __name__ == "__main__":
    sys.exit(main())
