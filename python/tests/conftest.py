"""A bag with known values, written by rosbags from the project's own message definitions; and the bag of a real program."""

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

DEFINITIONS = Path(__file__).resolve().parents[2] / "msgs" / "friction_msgs" / "msg"
START = 1_600_000_000_000_000_000


def store():
    types = get_typestore(Stores.ROS2_JAZZY)
    for file in sorted(DEFINITIONS.glob("*.msg")):
        types.register(get_types_from_msg(file.read_text(encoding="utf-8"), f"friction_msgs/msg/{file.stem}"))
    return types


def coulomb_viscous(velocity):
    """The friction of the bag [N m]."""
    return 0.09 * np.sign(velocity) + 0.04 * velocity


def write_bag(path: Path, namespace: str = "") -> None:
    """Two seconds at 500 Hz, a pause of three seconds, two seconds of position control; an estimate that is 0.01 N m low."""
    types = store()
    kinds = types.types
    header_kind, time_kind = kinds["std_msgs/msg/Header"], kinds["builtin_interfaces/msg/Time"]

    def header(stamp):
        return header_kind(time_kind(int(stamp // 10**9), int(stamp % 10**9)), "load_shaft")

    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {}

        def put(topic, kind, stamp, **values):
            name = f"{namespace}{topic}"
            if name not in connections:
                connections[name] = writer.add_connection(name, kind, typestore=types)
            message = kinds[kind](header=header(stamp), **values)
            writer.write(connections[name], stamp, types.serialize_cdr(message, kind))

        for index in range(2000):
            position_mode = index >= 1000
            stamp = START + index * 2_000_000 + (3_000_000_000 if position_mode else 0)
            t = index * 0.002
            velocity = 2.0 * np.cos(3.0 * t)
            torque = float(coulomb_viscous(velocity))
            put(
                "/joint_states",
                "sensor_msgs/msg/JointState",
                stamp,
                name=["load_shaft"],
                position=np.array([2.0 / 3.0 * np.sin(3.0 * t)]),
                velocity=np.array([velocity]),
                effort=np.array([torque]),
            )
            put(
                "/friction_estimate",
                "friction_msgs/msg/FrictionEstimate",
                stamp,
                model="lugre",
                torque=torque - 0.01,
                deflection=0.002,
                gamma=0.09,
                regime=1,
                velocity=velocity,
                residual=0.01,
            )
            put(
                "/controller_state",
                "friction_msgs/msg/ControllerState",
                stamp,
                mode=1 if position_mode else 0,
                reference=1.5,
                feedback=1.0,
                error=0.5 if index % 2 else -0.5,
                linear=1.0,
                inverse=0.0,
                friction=0.25,
                dither=0.0,
                total=1.25,
                saturated=False,
            )
            if index % 2 == 0:
                put("/motor_voltage", "friction_msgs/msg/MotorVoltage", stamp, voltage=float(index))
        put(
            "/diagnostics",
            "diagnostic_msgs/msg/DiagnosticArray",
            stamp,
            status=[
                kinds["diagnostic_msgs/msg/DiagnosticStatus"](
                    level=1,
                    name="rig_driver",
                    message="late",
                    hardware_id="",
                    values=[
                        kinds["diagnostic_msgs/msg/KeyValue"](key="overruns", value="3"),
                        kinds["diagnostic_msgs/msg/KeyValue"](key="state", value="active"),
                    ],
                )
            ],
        )


@pytest.fixture(scope="session")
def known(tmp_path_factory):
    """Paths of the known bag, plain and in the namespace axis_1."""
    folder = tmp_path_factory.mktemp("bags")
    plain, named = folder / "plain", folder / "named"
    write_bag(plain)
    write_bag(named, "/axis_1")
    return SimpleNamespace(plain=plain, named=named)


@pytest.fixture(scope="session")
def laboratory_bag():
    """A bag that `frictionlab run` or `live` has written, named by FRICTION_TEST_BAG."""
    named = os.environ.get("FRICTION_TEST_BAG")
    if not named:
        pytest.skip("FRICTION_TEST_BAG names no bag of the laboratory; `cargo test -p tests --test python_package` makes one")
    return Path(named)
