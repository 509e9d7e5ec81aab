"""Two rigs on one domain, each in its namespace; remappings; a parameter file. usage: namespace_session.py FOLDER"""

import json
import os
import sys
import tempfile

from friction_msgs.msg import MotorVoltage, Reference
from processes import Processes
from ros_calls import SIGNAL, caller
from sensor_msgs.msg import JointState

FILE = """\
/**:
  ros__parameters:
    compensation_scale: 0.5
/axis_2/*:
  ros__parameters: {mode: velocity}
axis_2:
  controller:
    ros__parameters:
      compensation_scale: 0.75
"""


def main() -> None:
    with caller() as ros, Processes(sys.argv[1]) as programs, tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "parameters.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(FILE)
        for axis in ("/axis_1", "/axis_2"):
            for program in ("rig_driver", "friction_observer"):
                programs.start(program, "-r", f"__ns:={axis}")
            programs.start("controller", "-r", f"__ns:={axis}", "--params-file", path, "-r", "reference:=/setpoint" if axis == "/axis_2" else "x:=y")
        joints = {"/axis_1": [], "/axis_2": []}
        keep = [ros.node.create_subscription(JointState, f"{axis}/joint_states", got.append, SIGNAL) for axis, got in joints.items()]
        first = ros.node.create_publisher(Reference, "/axis_1/reference", 10)
        second = ros.node.create_publisher(Reference, "/setpoint", 10)

        def send():
            first.publish(Reference(velocity=1.0))
            second.publish(Reference(velocity=-2.0))

        ros.node.create_timer(0.02, send)
        moving = ros.until(lambda: all(got and abs(got[-1].velocity[0]) > 0.5 for got in joints.values()), 40)

        def means():
            return {axis: sum(j.velocity[0] for j in got[-500:]) / len(got[-500:]) for axis, got in joints.items()}

        ros.spin(1.5)
        # On a busy machine this process hears of the start-up a while later.
        ros.until(lambda: abs(means()["/axis_1"] - 1.0) < 0.3 and abs(means()["/axis_2"] + 2.0) < 0.3, 10)
        mean = means()
        topics = dict(ros.node.get_topic_names_and_types())
        report = {
            "moving": moving,
            "velocity": mean,
            "nodes": ros.nodes(),
            "absolute": sorted(name for name in topics if name in ("/joint_states", "/motor_voltage", "/reference")),
            "scale": [ros.get(f"{axis}/controller", "compensation_scale")[0] for axis in joints],
            "joint_types": topics.get("/axis_1/joint_states"),
            "services": sorted(name for name, _ in ros.node.get_service_names_and_types() if name.endswith("/emergency_stop")),
            "keep": len(keep),
        }
        report["exit"] = [[code, took] for code, took, _ in (programs.end(p) for p in list(programs.running))]
        # names
        renamed = programs.start("controller", "-r", "__node:=arm", "-p", "arm:lag.k_p:=1.75", "-p", "other:lag.k_p:=9.0")
        report["renamed"] = [ros.get("/arm", "lag.k_p")[0], "/arm" in ros.nodes()]
        programs.end(renamed)
        # what is refused when a program starts
        refused = []
        for arguments in (["-p", "mode:=sideways"], ["-p", "lag.k_p:=2"], ["--bogus"], ["-r", "nonsense"], ["--params-file", "/no/such"]):
            process = programs.start("controller", *arguments)
            _, said = process.communicate(timeout=20)
            programs.running.remove(process)
            refused.append([arguments[-1], process.returncode, said])
        report["refused"] = refused
        print(json.dumps(report))


if __name__ == "__main__":
    main()
