"""A bag as one CSV table: one row a sample time, one column a quantity, units in the column names.

Time, position, velocity, friction torque, voltage, estimated torque, reference and error, as far as the bag has them.
`frictionlab identify` reads the file. For a table of each topic use `friction_analysis.read_bag` in Python.

  friction-table runs/live-1/bag table.csv
"""

from __future__ import annotations

import sys
from pathlib import Path

import pandas as pd

from friction_analysis.bag import BagError, read_bag
from friction_analysis.console import command, conclude
from friction_analysis.topics import topic_name

# Columns of a topic's table and their names in the common one. Torque is friction torque, positive against positive velocity.
COLUMNS: dict[str, dict[str, str]] = {
    "joint_states": {"position_rad": "position_rad", "velocity_rad_s": "velocity_rad_s", "torque_Nm": "torque_Nm"},
    "motor_voltage": {"voltage_V": "voltage_V"},
    "friction_estimate": {
        "torque_Nm": "estimated_torque_Nm",
        "deflection_rad": "deflection_rad",
        "gamma_Nm": "gamma_Nm",
    },
    "reference": {"position_rad": "reference_position_rad", "velocity_rad_s": "reference_velocity_rad_s"},
    "controller_state": {"error": "error", "friction_V": "friction_voltage_V"},
}


def read_table(path: Path, namespace: str = "") -> pd.DataFrame:
    """One row a sample time, the index `t_s` [s since the first of them].

    A quantity that was not recorded at a time is not a number there; one that the bag does not have gets no column.
    Raises `BagError`.
    """
    bag = read_bag(path, [topic_name(name, namespace) for name in COLUMNS])
    parts = []
    for name, columns in COLUMNS.items():
        if bag.has(name, namespace):
            part = bag.table(name, namespace)
            there = [column for column in columns if column in part]
            part = part[there].rename(columns=columns)
            parts.append(part[~part.index.duplicated(keep="last")])
    table = pd.concat(parts, axis=1, sort=True)
    if table.empty:
        raise BagError(f"{path} has no message on any of {', '.join(topic_name(name, namespace) for name in COLUMNS)}")
    table.index = pd.Index((table.index - table.index[0]).to_numpy().round(9), name="t_s")
    return table


def main(arguments: list[str] | None = None) -> int:
    """The command `friction-table`."""
    parser = command("friction-table", __doc__ or "")
    parser.add_argument("bag", type=Path, metavar="BAG", help="bag folder or .mcap file")
    parser.add_argument("table", type=Path, metavar="TABLE.csv", help="the file to write")
    parser.add_argument("--namespace", default="", metavar="NS", help="namespace of the axis, as in axis_1 (default: none)")
    given = parser.parse_args(arguments)

    def work() -> int:
        table = read_table(given.bag, given.namespace)
        table.to_csv(given.table, lineterminator="\n")
        print(f"{given.table}: {len(table)} rows, {len(table.columns) + 1} columns")
        return 0

    return conclude(work)


if __name__ == "__main__":
    sys.exit(main())
