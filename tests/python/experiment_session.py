"""Experiments on `frictionlab live`, and on the loop of the three nodes: to the end, with a node that dies, stopped, and with a runner that is killed.

usage: experiment_session.py FOLDER_OF_PROGRAMS FRICTIONLAB OUT
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from friction_msgs.msg import RigMeasurement
from processes import Processes
from ros_calls import SIGNAL, caller

# One compensation beside none, once: two runs of ten seconds.
SHORT = ["position-tracking", "--quick", "--repetitions", "1", "--model", "proposed"]
NODES = ("rig_driver", "friction_observer", "controller")


class Watch:
    """What the rig does."""

    def __init__(self, calls):
        self.calls = calls
        self.last = None
        calls.node.create_subscription(RigMeasurement, "/rig_measurement", self.hear, SIGNAL)

    def hear(self, message):
        self.last = message

    def moving(self):
        return self.last is not None and abs(self.last.voltage_applied) > 0.5

    def until_moving(self):
        assert self.calls.until(self.moving, 60.0), "the experiment does not move the rig"

    def finish(self, process):
        """Exit code and words of a program, once it has ended."""
        assert self.calls.until(lambda: process.poll() is not None, 90.0), "it does not end"
        return [process.returncode, process.stdout.read() + process.stderr.read()]


def run(program, out, *more):
    command = [program, "run", *SHORT, "--rig", "nodes", "--out", str(out), *more]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def ask(result):
    """Asks the experiment runner with the Python package."""
    command = [sys.executable, "-m", "friction_analysis.experiment", "position-tracking", "--model", "proposed"]
    command += ["--repetitions", "1", "--set", "quick", "--set", "rig=nodes", "--json", str(result)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ)


def over_live(calls, watch, program, out, report):
    live = subprocess.Popen([program, "live", "--reference", "ros", "--quiet", "--out", str(out / "live")], stdout=sys.stderr)
    assert calls.until(lambda: watch.last is not None, 20.0), "the live rig is not heard"
    report["over_live"] = watch.finish(run(program, out / "over_live"))
    live.send_signal(signal.SIGINT)
    report["live"] = live.wait(20.0)
    watch.last = None


def main():
    folder, program, out = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    report = {}
    with Processes(folder) as processes, caller() as calls:
        watch = Watch(calls)
        # The nodes in one process; in the long tier only, since it takes as long as it says.
        if "FRICTION_FULL" in os.environ:
            over_live(calls, watch, program, out, report)

        # Three processes.
        given = {"friction_observer": ["-p", "model:=lugre"]}
        nodes = {name: processes.start(name, *given.get(name, [])) for name in NODES}
        assert calls.until(lambda: watch.last is not None, 20.0), "the rig is not heard"

        # A client that is new waits long for its first answer; this one is wanted in a hurry later.
        calls.change("/rig_driver", "activate")
        report["whole"] = watch.finish(run(program, out / "whole"))
        report["left"] = [calls.state(f"/{name}") for name in NODES]
        report["model_left"] = calls.get("/friction_observer", "model")
        report["compensation_left"] = calls.get("/controller", "compensation", "mode")

        # A node that dies in the middle.
        # What this program prints is the report alone.
        server = subprocess.Popen([program, "serve", "--quiet", "--runs", str(out / "served")], stdout=sys.stderr)
        asking = ask(out / "result.json")
        watch.until_moving()
        calls.spin(2.0)
        processes.end(nodes["friction_observer"], signal.SIGKILL)
        report["died"] = [*watch.finish(asking), json.loads((out / "result.json").read_text())]
        calls.spin(0.2)
        report["after_death"] = [calls.state("/rig_driver"), watch.last.voltage_applied, watch.last.fault]
        server.send_signal(signal.SIGINT)
        report["server"] = server.wait(20.0)

        # Stopped by ctrl-C.
        nodes["friction_observer"] = processes.start("friction_observer")
        calls.spin(1.0)
        stopped = run(program, out / "stopped")
        watch.until_moving()
        stopped.send_signal(signal.SIGINT)
        asked = time.monotonic()
        calls.until(lambda: watch.last.voltage_applied == 0.0, 10.0)
        report["zero_after"] = time.monotonic() - asked
        report["stopped"] = watch.finish(stopped)

        # Somebody deactivates the rig meanwhile.
        third = run(program, out / "deactivated")
        watch.until_moving()
        calls.change("/rig_driver", "deactivate")
        report["deactivated"] = watch.finish(third)

        # Killed.
        killed = run(program, out / "killed")
        watch.until_moving()
        calls.spin(3.0)
        killed.kill()
        report["killed_at"] = time.time_ns()
        killed.communicate()
        calls.spin(1.5)
        report["after_kill"] = abs(watch.last.tachometer_velocity)
    print(json.dumps(report))


if __name__ == "__main__":
    main()
