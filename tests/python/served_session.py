"""Every service that a node shows is asked. Prints, for each way to run them, the services of each node with what came of it.

usage: served_session.py FOLDER FRICTIONLAB WAY...

Each way is the arguments of the command. Asked is what changes nothing: a request without contents.
"""

import importlib
import json
import os
import signal
import subprocess
import sys
import tempfile

from ros_calls import caller

RUNNER = "/experiment_runner"
LOOP = ("/rig_driver", "/friction_observer", "/controller", RUNNER)
# What drives or ends something, and what belongs to an action and is asked by its client.
LEFT_OUT = ("/change_state", "/emergency_stop", "/clear_fault", "/zero_sensors", "/identify", "/start_experiment")
ASKER = "asker"


def kind_of(name):
    package, _, kind = name.split("/")
    return getattr(importlib.import_module(f"{package}.srv"), kind)


def ask(ros, name, kind):
    """Whether a service answers within the time that people wait."""
    kind = kind_of(kind)
    try:
        return ros.call(kind, name, kind.Request(), 15) is not None
    except RuntimeError as error:
        return str(error)


def nodes(ros, arguments, out):
    """Services of every node with what came of asking; a node without those of parameters is asked for them, as `ros2 param list` asks it."""
    with open(os.path.join(out, "said"), "w+", encoding="utf-8") as said:
        running = subprocess.Popen([sys.argv[2], *arguments], stdout=said, stderr=said, cwd=out)
        try:
            others = lambda: {name for name in ros.nodes() if name != f"/{ASKER}"}
            wanted = {RUNNER} if arguments == ["serve"] else set(LOOP)
            assert ros.until(lambda: wanted <= others(), 40), f"{arguments}: only {others()} came"
            # The last services follow the nodes' names.
            ros.spin(3)
            report = {}
            for node in sorted(others()):
                shown = ros.node.get_service_names_and_types_by_node(node.lstrip("/"), "/")
                asked = {f"{node}/list_parameters": "rcl_interfaces/srv/ListParameters"} | {name: kinds[0] for name, kinds in shown}
                report[node] = {
                    name: ask(ros, name, kind) for name, kind in sorted(asked.items()) if "/_action/" not in name and not name.endswith(LEFT_OUT)
                }
            return report
        finally:
            running.send_signal(signal.SIGINT)
            running.wait(timeout=30)


def main() -> None:
    report = {}
    for way in sys.argv[3:]:
        # A participant of its own each time: what is seen is what is there, not what was.
        with tempfile.TemporaryDirectory() as out, caller(ASKER) as ros:
            report[way] = nodes(ros, way.split(), out)
    print(json.dumps(report))


if __name__ == "__main__":
    main()
