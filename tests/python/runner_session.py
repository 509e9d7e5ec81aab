"""Asks the experiment runner with rclpy for everything it offers, well and badly, and writes down what it answered.

usage: runner_session.py RESULT.json RUNS_FOLDER PROGRAM ARGUMENT...
"""

import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import rclpy
from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from friction_msgs.action import RunExperiment
from friction_msgs.msg import ExperimentStatus, Setting
from friction_msgs.srv import Identify, ListExperiments, StartExperiment
from processes import there
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_srvs.srv import Trigger

PATIENCE = 180.0
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def settings(**values) -> list:
    return [Setting(name=name.replace("_", "-"), value=str(value).lower()) for name, value in values.items()]


def goal(experiment, repetitions=1, models=("lugre",), folder="", preempt=False, **overrides):
    return RunExperiment.Goal(
        experiment=experiment,
        models=list(models),
        repetitions=repetitions,
        overrides=settings(**overrides),
        output_folder=str(folder),
        preempt=preempt,
    )


class Session:
    def __init__(self, command: list[str]) -> None:
        rclpy.init()
        self.node = rclpy.create_node("asker")
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(self.node)
        threading.Thread(target=self.executor.spin, daemon=True).start()
        self.statuses = []
        self.node.create_subscription(ExperimentStatus, "/experiment_status", self.statuses.append, LATCHED)
        self.goal_statuses = []
        self.node.create_subscription(
            GoalStatusArray, "/experiment_runner/run_experiment/_action/status", self.goal_statuses.append, LATCHED
        )
        self.action = ActionClient(self.node, RunExperiment, "/experiment_runner/run_experiment")
        self.clients = {
            name: self.node.create_client(kind, f"/experiment_runner/{name}")
            for name, kind in {
                "start_experiment": StartExperiment,
                "list_experiments": ListExperiments,
                "identify": Identify,
                "abort": Trigger,
            }.items()
        }
        self.process = subprocess.Popen([*there(), *command])
        assert self.action.wait_for_server(timeout_sec=30.0), "the action is not offered"
        for name, client in self.clients.items():
            assert client.wait_for_service(timeout_sec=30.0), f"{name} is not offered"

    def wait(self, future, seconds=PATIENCE):
        done = threading.Event()
        future.add_done_callback(lambda _: done.set())
        assert done.wait(seconds), f"no answer within {seconds} s"
        return future.result()

    def until(self, condition, seconds=PATIENCE) -> bool:
        end = time.monotonic() + seconds
        while not condition() and time.monotonic() < end:
            time.sleep(0.02)
        return bool(condition())

    def call(self, name, request):
        return self.wait(self.clients[name].call_async(request))

    def send(self, request, feedback=None):
        heard = None if feedback is None else lambda message: feedback.append(message.feedback)
        return self.wait(self.action.send_goal_async(request, feedback_callback=heard))

    def run(self, request, feedback=None) -> dict:
        handle = self.send(request, feedback)
        if not handle.accepted:
            return {"accepted": False}
        return {"accepted": True, **self.result(handle)}

    def result(self, handle) -> dict:
        answer = self.wait(handle.get_result_async())
        return {"status": answer.status, **plain(answer.result)}

    def running(self) -> bool:
        return bool(self.statuses) and self.statuses[-1].experiment != "" and self.statuses[-1].progress > 0

    def latecomer(self) -> dict:
        """The status as somebody sees it who joins now."""
        late = rclpy.create_node("latecomer")
        heard = []
        late.create_subscription(ExperimentStatus, "/experiment_status", heard.append, LATCHED)
        self.executor.add_node(late)
        self.until(lambda: heard, 10.0)
        time.sleep(0.3)
        self.executor.remove_node(late)
        late.destroy_node()
        return plain(heard[-1]) if heard else {}


def plain(value):
    """A message as dictionaries and lists; what is not a number becomes null."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def main() -> None:
    result, runs, *command = sys.argv[1:]
    session = Session(command)
    try:
        report = converse(session, Path(runs))
    except BaseException:
        session.process.kill()
        raise
    Path(result).write_text(json.dumps(report), encoding="utf-8")
    os._exit(0)


def converse(session: Session, runs: Path) -> dict:
    report = {}

    session.until(lambda: session.statuses, 10.0)
    report["first_status"] = plain(session.statuses[-1]) if session.statuses else {}
    report["list"] = plain(session.call("list_experiments", ListExperiments.Request()))
    report["nothing_to_abort"] = plain(session.call("abort", Trigger.Request()))

    # Bad requests. Nothing may move and nothing may be written.
    runs.mkdir(exist_ok=True)
    blocked = runs / "a_file"
    blocked.write_text("mine")
    report["bad"] = {
        "unknown": session.run(goal("positon-tracking")),
        "model": session.run(goal("velocity-tracking", models=("newton",))),
        "folder": session.run(goal("velocity-tracking", folder="a_file/run")),
        "outside": session.run(goal("velocity-tracking", folder=runs.parent / "elsewhere")),
        "above": session.run(goal("velocity-tracking", folder="../elsewhere")),
        "file": session.run(goal("velocity-tracking", protocol="/etc/passwd")),
        "endless": session.run(goal("velocity-tracking", parameters="/dev/zero")),
        "rig": session.run(goal("velocity-tracking", rig="serial:/dev/ttyS0")),
        "card": session.run(goal("velocity-tracking", rig="quanser")),
        "range": session.run(goal("velocity-tracking", voltage_limit=50)),
        "option": session.run(goal("velocity-tracking", velocity=3)),
        "start": plain(session.call("start_experiment", StartExperiment.Request(experiment="jump"))),
        "identify": plain(session.call("identify", Identify.Request(bag_path="nowhere/bag"))),
    }
    report["after_bad"] = sorted(path.name for path in runs.iterdir())

    # One experiment to its end, with feedback; the result can be asked for again.
    feedback = []
    handle = session.send(goal("constant-velocity", repetitions=30, quick=True, seed=3), feedback)
    report["complete"] = session.result(handle)
    report["asked_again"] = session.result(handle)
    report["feedback"] = [plain(message) for message in feedback]
    report["after_complete"] = session.latecomer()

    # Identification from its bag.
    request = Identify.Request(
        # Relative to the folder of runs, as everything that a request names.
        bag_path=report["complete"]["run_id"] + "/bag",
        models=["coulomb_viscous", "stribeck"],
        overrides=settings(no_joint=True),
    )
    report["identify"] = plain(session.call("identify", request))

    # The Python package's own client.
    command = [sys.executable, "-m", "friction_analysis.experiment", "velocity-tracking", "--model", "lugre"]
    client = subprocess.run([*command, "--set", "quick", "--set", "seed=5"], capture_output=True, text=True)
    report["client"] = {"code": client.returncode, "out": client.stdout, "err": client.stderr}
    client = subprocess.run([*command, "--set", "velocity=3"], capture_output=True, text=True)
    report["bad_client"] = {"code": client.returncode, "out": client.stdout, "err": client.stderr}

    # A long one: somebody comes late, a second is refused, then it is cancelled.
    handle = session.send(goal("position-tracking", repetitions=1000))
    assert session.until(session.running), "the long experiment does not run"
    report["while_running"] = session.latecomer()
    report["second"] = session.run(goal("velocity-tracking"))
    report["second_start"] = plain(
        session.call("start_experiment", StartExperiment.Request(experiment="velocity-tracking"))
    )
    asked = time.monotonic()
    cancelled = session.wait(handle.cancel_goal_async())
    report["cancel_answer"] = {
        "return_code": cancelled.return_code,
        "goals": len(cancelled.goals_canceling),
        "rejected": CancelGoal.Response.ERROR_REJECTED,
    }
    report["cancelled"] = session.result(handle)
    report["cancel_seconds"] = time.monotonic() - asked
    report["cancel_again"] = session.wait(handle.cancel_goal_async()).return_code

    # At the pace of the clock: a run of 58.7 s, cancelled soon after its start.
    handle = session.send(goal("velocity-tracking", real_time=True))
    assert session.until(lambda: session.statuses[-1].experiment != ""), "the slow experiment does not run"
    session.wait(handle.cancel_goal_async())
    report["cancelled_in_real_time"] = session.result(handle)

    # Started and left alone, then aborted by the service.
    request = StartExperiment.Request(experiment="position-tracking", models=["lugre"], repetitions=1000)
    report["started"] = plain(session.call("start_experiment", request))
    assert session.until(session.running), "the started experiment does not run"
    report["abort"] = plain(session.call("abort", Trigger.Request()))
    assert session.until(lambda: session.statuses[-1].experiment == ""), "it does not end"
    report["after_abort"] = plain(session.statuses[-1])

    # Preemption: the first ends, the second runs.
    first = session.send(goal("position-tracking", repetitions=1000))
    assert session.until(session.running), "the first of two does not run"
    second = session.send(goal("velocity-tracking", preempt=True))
    report["preempted"] = session.result(first)
    report["preempting"] = session.result(second)

    report["goal_statuses"] = sorted({s.status for array in session.goal_statuses for s in array.status_list})
    report["codes"] = {
        name: getattr(GoalStatus, f"STATUS_{name}") for name in ("SUCCEEDED", "CANCELED", "ABORTED", "CANCELING")
    }

    # SIGINT while one runs: it ends it, keeps its bag and leaves.
    handle = session.send(goal("position-tracking", repetitions=1000))
    assert session.until(session.running), "the last experiment does not run"
    asked = time.monotonic()
    session.process.send_signal(signal.SIGINT)
    report["interrupted"] = session.result(handle)
    report["exit_code"] = session.process.wait(timeout=PATIENCE)
    report["exit_seconds"] = time.monotonic() - asked
    gone = session.until(lambda: "experiment_runner" not in session.node.get_node_names(), 10.0)
    report["gone"] = gone
    return report


if __name__ == "__main__":
    main()
