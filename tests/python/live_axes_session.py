"""Two `frictionlab live` on one domain, each in a namespace of its own. usage: live_axes_session.py PROGRAM FOLDER"""

import json
import os
import sys

from friction_msgs.msg import Reference, RigMeasurement
from live_nodes_session import Live
from ros_calls import SIGNAL, caller

WANTED = {"/axis_1": 1.0, "/axis_2": -2.0}


def main() -> None:
    program, folder = sys.argv[1:]
    with caller() as ros:
        measured = {axis: [] for axis in WANTED}
        keep = [ros.node.create_subscription(RigMeasurement, f"{axis}/rig_measurement", got.append, SIGNAL) for axis, got in measured.items()]
        lives = [
            Live(program, os.path.join(folder, axis.strip("/")), "--reference", "ros", "--ros-args", "-r", f"__ns:={axis}") for axis in WANTED
        ]
        publishers = {axis: ros.node.create_publisher(Reference, f"{axis}/reference", 10) for axis in WANTED}
        ros.node.create_timer(0.02, lambda: [publishers[axis].publish(Reference(velocity=v)) for axis, v in WANTED.items()])

        def velocity(axis):
            """Mean over the last half second [rad/s], by the encoder."""
            if len(measured[axis]) <= 500:
                return 99.0
            first, last = measured[axis][-500], measured[axis][-1]
            return (last.encoder_position - first.encoder_position) / (last.rig_time - first.rig_time)

        def follows(axis):
            return abs(velocity(axis) - WANTED[axis]) < 0.35

        def stands(axis):
            return velocity(axis) == 0.0 and measured[axis][-1].voltage_applied == 0.0

        report = {"follow": ros.until(lambda: all(follows(axis) for axis in WANTED), 40), "velocities": [velocity(axis) for axis in WANTED]}
        report["nodes"] = sorted(node for node in ros.nodes() if "/axis_" in node)
        report["stop"] = ros.trigger("/axis_1/rig_driver/emergency_stop")
        report["stands"] = ros.until(lambda: stands("/axis_1"), 20)
        report["other_goes_on"] = follows("/axis_2")
        report["exits"] = [live.end()[:2] for live in lives]
        report["keep"] = len(keep)
        print(json.dumps(report))


if __name__ == "__main__":
    main()
