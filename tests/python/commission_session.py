"""Commissions over the action, with rclpy: on the simulated rig to the end, cancelled and gone on with; on nodes that run, cancelled, and in the long tier to the end.

usage: commission_session.py RESULT.json FOLDER_OF_PROGRAMS RUNS_FOLDER PROGRAM
"""

import json
import os
import signal
import sys
from pathlib import Path

from friction_msgs.msg import RigMeasurement
from friction_msgs.srv import ListExperiments
from processes import Processes
from ros_calls import SIGNAL
from runner_session import Session, goal, plain

NODES = ("rig_driver", "friction_observer", "controller")

# A machine that is busy may keep a command or a measurement back for half a second, and the motor
# stands then, as it should. What is wrong in the nodes shows each time.
TRIES = 3
LATE = ("command lost", "not heard for half a second")


def commission(**options):
    return goal("commission", repetitions=0, models=(), **options)


def simulated(session, runs):
    report = {}
    feedback = []
    report["complete"] = session.run(commission(minutes=10), feedback)
    report["feedback"] = [plain(message) for message in feedback]

    # Cancelled at once, and gone on with.
    handle = session.send(commission())
    session.wait(handle.cancel_goal_async())
    report["cancelled"] = session.result(handle)
    name = report["cancelled"]["run_id"]
    report["left"] = sorted(path.name for path in (runs / name).iterdir()) if (runs / name).is_dir() else []
    if "rig.json" in report["left"]:
        report["resumed"] = session.run(commission(resume=name))

    report["bad"] = {
        "rig": session.run(commission(rig="serial:/dev/ttyS0")),
        "models": session.run(goal("commission", models=("lugre",), repetitions=0)),
        "option": session.run(commission(minuts=3)),
        "minutes": session.run(commission(minutes=1)),
        "folder": session.run(commission(resume="nowhere")),
        "wish": session.run(commission(want="f_q:2%")),
    }
    listed = session.call("list_experiments", ListExperiments.Request())
    report["listed"] = [plain(one) for one in listed.experiments if one.name == "commission"]
    return report


def moving_commission(session, heard, feedback):
    """A commission over the nodes in its ramps, or None where a command was late before."""

    def moves():
        return abs(heard[-1].voltage_applied) > 0.1

    handle = session.send(commission(rig="nodes"), feedback)
    ended = handle.get_result_async()
    ramps = lambda: feedback and "ramps" in feedback[-1].stage and moves()
    session.until(lambda: ramps() or ended.done(), 90.0)
    said = ended.result().result.message if ended.done() else ""
    if any(late in said for late in LATE):
        print(f"late by half a second: {said}", flush=True)
        return None
    assert ramps(), f"it does not move: {[f.stage for f in feedback[-3:]]}, {said}"
    return handle


def over_nodes(session, folder):
    for _ in range(TRIES):
        with Processes(folder) as processes:
            report = over_fresh_nodes(session, processes)
        if report is not None:
            return report
    raise AssertionError(f"late by half a second in each of {TRIES} commissions")


def over_fresh_nodes(session, processes):
    report = {}
    heard = []
    listening = session.node.create_subscription(RigMeasurement, "/rig_measurement", heard.append, SIGNAL)
    for name in NODES:
        processes.start(name)
    assert session.until(lambda: heard, 30.0), "the rig is not heard"

    feedback = []
    handle = moving_commission(session, heard, feedback)
    if handle is None:
        session.node.destroy_subscription(listening)
        return None
    session.wait(handle.cancel_goal_async())
    report["cancelled"] = session.result(handle)
    report["stages"] = sorted({message.stage for message in feedback})
    session.until(lambda: abs(heard[-1].voltage_applied) <= 0.1, 5.0)
    report["volts"] = heard[-1].voltage_applied
    if "FRICTION_FULL" in os.environ or "COMMISSION_NODES" in os.environ:
        feedback = []
        name = report["cancelled"]["run_id"]
        handle = session.send(commission(rig="nodes", resume=name), feedback)
        answer = session.wait(handle.get_result_async(), 1500.0)
        report["complete"] = {"status": answer.status, **plain(answer.result)}
        report["feedback"] = [plain(message) for message in feedback]
    return report


def main():
    result, folder, runs, program = sys.argv[1:]
    runs = Path(runs)
    runs.mkdir(exist_ok=True)
    session = Session([program, "serve", "--quiet", "--runs", str(runs)])
    try:
        report = {"simulated": simulated(session, runs), "nodes": over_nodes(session, folder)}
    except BaseException:
        session.process.kill()
        raise
    session.process.send_signal(signal.SIGINT)
    report["exit_code"] = session.process.wait(timeout=60)
    Path(result).write_text(json.dumps(report), encoding="utf-8")
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
