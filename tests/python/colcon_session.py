"""`ros2 launch friction_bringup friction.launch.py` in a workspace that colcon built and that was sourced: which programs run, and whether the loop does. Prints a
report.

Where there is no `ros2 launch`, its words come from the stand-in for `launch`.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from ament_index_python import get_package_prefix, get_package_share_directory
from launch_stub import launch
from ros_calls import SIGNAL, caller

LOOP = ("rig_driver", "friction_observer", "controller")


def started() -> list[subprocess.Popen]:
    """The launcher, or what it would have started."""
    quiet = {"stdout": sys.stderr, "stderr": sys.stderr, "stdin": subprocess.PIPE}
    if shutil.which("ros2"):
        return [subprocess.Popen(["ros2", "launch", "friction_bringup", "friction.launch.py"], **quiet)]
    file = Path(get_package_share_directory("friction_bringup")) / "launch/friction.launch.py"
    return [
        subprocess.Popen(process.command(), env={**os.environ, **process.additional_env}, **quiet) for process in launch(file).started
    ]


def programs() -> list[str]:
    """Programs of the workspace that run."""
    prefix = os.path.realpath(get_package_prefix("friction_nodes"))
    found = []
    for entry in Path("/proc").iterdir():
        try:
            file = os.readlink(entry / "exe")
        except OSError:
            continue
        if file.startswith(prefix):
            found.append(file)
    return sorted(found)


def main() -> None:
    # The types of the workspace, not others that are installed beside it.
    from friction_msgs.msg import FrictionEstimate

    report = {"types": sys.modules["friction_msgs"].__file__}
    with caller("peer") as ros:
        running = started()
        estimates = []
        ros.node.create_subscription(FrictionEstimate, "/friction_estimate", estimates.append, SIGNAL)
        ros.until(lambda: len(estimates) > 1000, 60)
        report["states"] = {name: ros.state(f"/{name}") for name in LOOP}
        report["estimates"] = len(estimates)
        report["programs"] = programs()
        for process in running:
            process.send_signal(signal.SIGINT)
        report["codes"] = [process.wait(30) for process in running]
        until = time.monotonic() + 20
        while programs() and time.monotonic() < until:
            time.sleep(0.1)
        report["left"] = programs()
    print(json.dumps(report))


if __name__ == "__main__":
    main()
