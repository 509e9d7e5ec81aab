"""`frictionlab launch` beside rclpy: what its nodes offer, `frictionlab doctor` beside them, ctrl-C, a node that is killed. Prints a report.

usage: launch_session.py FOLDER FRICTIONLAB BAG
"""

import json
import os
import signal
import subprocess
import sys
import time

from rclpy.action import get_action_server_names_and_types_by_node
from ros_calls import caller

NODES = ("rig_driver", "friction_observer", "controller", "experiment_runner")


def children(pid):
    """Process numbers of a process's children, by node: `frictionlab node NAME`."""
    found = {}
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", encoding="utf-8") as file:
                parent = int(file.read().rsplit(")", 1)[1].split()[1])
            if parent == pid:
                with open(f"/proc/{entry}/cmdline", encoding="utf-8") as file:
                    words = file.read().split("\0")
                found[words[2] if words[1:2] == ["node"] else os.path.basename(words[0])] = int(entry)
        except OSError:
            continue
    return found


def running(pid):
    return os.path.exists(f"/proc/{pid}")


def offered(node):
    """Topics and services of every node, as `ros2 node info` shows them."""
    return {
        name: {
            "publishes": dict(node.get_publisher_names_and_types_by_node(name, "/")),
            "hears": dict(node.get_subscriber_names_and_types_by_node(name, "/")),
            "serves": dict(node.get_service_names_and_types_by_node(name, "/")),
            "acts": dict(get_action_server_names_and_types_by_node(node, name, "/")),
        }
        for name in NODES
    }


def seen(ros):
    return {name for name, _ in ros.node.get_node_names_and_namespaces()}


def complete(ros):
    """All four nodes are there, with the last thing each of them offers."""
    if not set(NODES) <= seen(ros):
        return False
    names = {name for name, _ in ros.node.get_service_names_and_types()}
    last = {"/rig_driver/zero_sensors", "/friction_observer/reset", "/controller/reset", "/experiment_runner/run_experiment/_action/send_goal"}
    return last <= names


def start(program, *arguments):
    return subprocess.Popen([program, "launch", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def end(process, how):
    begun = time.monotonic()
    if how is not None:
        process.send_signal(how)
    said, _ = process.communicate(timeout=30)
    return {"code": process.returncode, "seconds": time.monotonic() - begun, "said": said}


def main() -> None:
    program = sys.argv[2]
    report = {}
    with caller("peer") as ros:
        first = start(program, "model:=lugre")
        assert ros.until(lambda: complete(ros), 40), f"not all nodes came: {seen(ros)}"
        ros.until(lambda: False, 2)
        report["offered"] = offered(ros.node)
        report["model"] = ros.get("/friction_observer", "model")
        doctor = subprocess.run([program, "doctor", "--json"], capture_output=True, text=True, check=False)
        report["doctor"] = {"code": doctor.returncode, "found": json.loads(doctor.stdout)}
        nodes = children(first.pid)
        report["children"] = sorted(nodes)
        report["interrupted"] = end(first, signal.SIGINT)
        report["left"] = [name for name, pid in nodes.items() if running(pid)]
        report["gone"] = ros.until(lambda: not set(NODES) & seen(ros), 10)

        second = start(program, "namespace:=axis_1", f"record:={sys.argv[3]}")
        spaces = lambda: {name for name, space in ros.node.get_node_names_and_namespaces() if space == "/axis_1"}
        report["in_namespace"] = ros.until(lambda: set(NODES) <= spaces(), 40)
        ros.until(lambda: False, 3)
        nodes = children(second.pid)
        os.kill(nodes["friction_observer"], signal.SIGKILL)
        report["killed"] = end(second, None)
        report["left_after_kill"] = [name for name, pid in nodes.items() if running(pid)]
    print(json.dumps(report))


if __name__ == "__main__":
    main()
