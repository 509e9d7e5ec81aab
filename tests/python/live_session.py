"""Subscribes with rclpy while the laboratory runs live, and writes down what arrived.

usage: live_session.py RESULT.json PROGRAM ARGUMENT...

The program is started once the subscriptions stand. Numbers go into the result as the bits of their doubles, so that
the comparison with the bag can be exact.
"""

import json
import struct
import subprocess
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from friction_msgs.msg import FrictionEstimate, MotorVoltage
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState


def bits(value: float) -> int:
    return struct.unpack("<Q", struct.pack("<d", value))[0]


def stamp(message) -> int:
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


TOPICS = {
    "/joint_states": (JointState, lambda m: [*m.position, *m.velocity, *m.effort]),
    "/friction_estimate": (
        FrictionEstimate,
        lambda m: [m.torque, m.deflection, m.gamma, float(m.regime), m.velocity, m.residual],
    ),
    "/motor_voltage": (MotorVoltage, lambda m: [m.voltage]),
}


def main() -> None:
    result, *command = sys.argv[1:]
    rclpy.init()
    node = rclpy.create_node("listener")
    profile = QoSProfile(depth=2000, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.RELIABLE)
    arrived = {topic: [] for topic in [*TOPICS, "/diagnostics"]}
    subscriptions = [
        node.create_subscription(kind, topic, arrived[topic].append, profile) for topic, (kind, _) in TOPICS.items()
    ]
    subscriptions.append(node.create_subscription(DiagnosticArray, "/diagnostics", arrived["/diagnostics"].append, 10))

    process = subprocess.Popen(command)
    nodes: set[str] = set()
    looked = 0.0
    while process.poll() is None:
        rclpy.spin_once(node, timeout_sec=0.05)
        if time.monotonic() - looked > 0.5:
            looked = time.monotonic()
            nodes.update(node.get_node_names())
    quiet = time.monotonic() + 1.0
    while time.monotonic() < quiet:
        rclpy.spin_once(node, timeout_sec=0.05)

    report = {
        "exit_code": process.returncode,
        "nodes": sorted(nodes),
        "joint_names": sorted({name for message in arrived["/joint_states"] for name in message.name}),
        "models": sorted({message.model for message in arrived["/friction_estimate"]}),
        "diagnostics": [
            {value.key: value.value for value in status.values}
            for message in arrived["/diagnostics"]
            for status in message.status
        ],
        "topics": {
            topic: [[stamp(message), [bits(value) for value in values(message)]] for message in arrived[topic]]
            for topic, (_, values) in TOPICS.items()
        },
    }
    with open(result, "w", encoding="utf-8") as file:
        json.dump(report, file)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
