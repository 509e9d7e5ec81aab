"""What people do with nodes of ROS, done over Cyclone DDS while rclpy asks the same nodes over Fast DDS. usage: cyclone_session.py FOLDER FRICTIONLAB ROS_PYTHON"""

import json
import os
import subprocess
import sys
from pathlib import Path

from cyclone_ros import *  # noqa: F403
from processes import Processes, there

DOMAIN = int(os.environ.get("ROS_DOMAIN_ID", "0"))
OBSERVER, RIG = "/friction_observer", "/rig_driver"
ACTION = "friction_msgs/action/RunExperiment"


def main() -> None:
    ros = Ros(DOMAIN)
    with Processes(sys.argv[1]) as programs:
        # Nobody knows this one; it is for the programs only.
        os.environ["RMW_IMPLEMENTATION"] = "rmw_cyclone"
        for program in ("rig_driver", "friction_observer", "controller"):
            programs.start(program)
        del os.environ["RMW_IMPLEMENTATION"]
        report = {"topics": topics(ros)}
        beside = subprocess.Popen(
            [sys.argv[3], str(Path(__file__).with_name("cyclone_beside.py"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert beside.stdout.readline() == "asking\n"
        report["parameters"] = parameters(ros)
        report["lifecycle"] = lifecycle(ros)
        report["stop"] = stop(ros)
        said, _ = beside.communicate("", timeout=60)
        report["beside"] = json.loads(said)
        report["endpoints"], report["participants"] = ros.endpoints(), ros.participants()
        report["said"] = "".join(programs.end(program)[2] for program in list(programs.running))
    report["action"], report["action_endpoints"] = action(ros)
    print(json.dumps(report), flush=True)


def topics(ros) -> dict:
    states = ros.subscription("/joint_states", JOINT_STATE)
    reference = ros.publisher("/reference", REFERENCE)
    controlled = ros.subscription("/controller_state", kind("friction_msgs/msg/ControllerState", CONTROLLER_STATE))
    heard, followed = [], []

    def exchanged():
        reference.write(REFERENCE(STAMPED(TIME(0, 0), ""), 0.0, 0.125, 0.0))
        heard.extend(states.take(100))
        followed.extend(sample.reference for sample in controlled.take(100))
        return len(heard) > 100 and 0.125 in followed

    good = until(exchanged, 30)
    return {"exchanged": good, "joint": list(heard[-1].name) if heard else [], "states": len(heard)}


CONTROLLER_STATE = {"header": STAMPED, "mode": uint8, "reference": float64}


def parameters(ros) -> dict:
    of = "rcl_interfaces/srv/"
    listing = ros.client(
        OBSERVER + "/list_parameters",
        of + "ListParameters",
        {"prefixes": sequence[str], "depth": uint64},
        {"result": LISTED},
    ).wait()
    getting = ros.client(
        OBSERVER + "/get_parameters", of + "GetParameters", {"names": sequence[str]}, {"values": sequence[VALUE]}
    ).wait()
    setting = ros.client(
        OBSERVER + "/set_parameters",
        of + "SetParameters",
        {"parameters": sequence[PARAMETER]},
        {"results": sequence[WAS_SET]},
    ).wait()
    listed = listing.call([], 0).result.names
    before = getting.call(["injection"]).values[0].double_value
    good = setting.call([double("injection", 1.5)]).results[0]
    bad = setting.call([double("injection", 1e9)]).results[0]
    return {
        "listed": len(listed),
        "lists": [len(listing.call([], 0).result.names) for _ in range(30)],
        "values": [before, getting.call(["injection"]).values[0].double_value],
        "set": [[good.successful, good.reason], [bad.successful, bad.reason]],
        "of_others": listing.others,
    }


def lifecycle(ros) -> dict:
    of = "lifecycle_msgs/srv/"
    change = ros.client(OBSERVER + "/change_state", of + "ChangeState", {"transition": TRANSITION}, {"success": bool}).wait()
    state = ros.client(OBSERVER + "/get_state", of + "GetState", None, {"current_state": STATE}).wait()
    seen = [state.call().current_state.label]
    for transition in (4, 3):
        assert change.call(TRANSITION(transition, "")).success
        seen.append(state.call().current_state.label)
    return {"states": seen, "wrong": change.call(TRANSITION(1, "")).success}


def stop(ros) -> dict:
    of = "std_srvs/srv/Trigger"
    answer = {"success": bool, "message": str}
    stopping = ros.client(RIG + "/emergency_stop", of, None, answer).wait()
    said = stopping.call()
    # Too short for a request: in front of the data stands half of what should.
    short = kind(of + "_Request", {"client": uint64})
    writer = ros.writer(f"rq{RIG}/emergency_stop" + "Request", short)
    assert until(writer.get_matched_subscriptions, 20), "nobody reads the request"
    writer.write(short(7))
    return {"success": said.success, "message": said.message, "again": stopping.call().success}


def action(ros):
    runs = Path(os.environ["ROS_LOG_DIR"]) / "runs"
    serving = subprocess.Popen([*there(), sys.argv[2], "serve", "--runs", str(runs)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    try:
        base = "/experiment_runner/run_experiment/_action/"
        sending = ros.client(
            base + "send_goal",
            ACTION + "_SendGoal",
            {
                "goal_id": UUID,
                "experiment": str,
                "models": sequence[str],
                "repetitions": uint32,
                "overrides": sequence[SETTING],
                "output_folder": str,
                "preempt": bool,
            },
            {"accepted": bool, "stamp": TIME},
        ).wait(30)
        asking = ros.client(
            base + "get_result",
            ACTION + "_GetResult",
            {"goal_id": UUID},
            {"status": uint8, "success": bool, "outcome": uint8, "message": str, "run_id": str},
        ).wait()
        cancelling = ros.client(
            base + "cancel_goal",
            "action_msgs/srv/CancelGoal",
            {"goal_id": UUID, "stamp": TIME},
            {"return_code": uint8, "goals": sequence[kind("action_msgs/msg/GoalInfo", {"goal_id": UUID, "stamp": TIME})]},
        ).wait()
        feedback = ros.subscription(
            base + "feedback", kind(ACTION + "_FeedbackMessage", {"goal_id": UUID, "stage": str, "repetition": uint32, "progress": float64})
        )
        until(feedback.get_matched_publications, 10)
        goal = list(range(16))
        quick = [SETTING("quick", "true")]
        accepted = sending.call(goal, "pre-sliding", ["lugre"], 1, quick, "", False).accepted
        wanted = asking.send(goal)
        result = asking.answer(wanted, 120)
        again = asking.call(goal)
        late = cancelling.call(goal, TIME(0, 0))
        told = feedback.take(1000)
        return {
            "accepted": accepted,
            "result": [result.status, result.success, result.message],
            "again": again.run_id == result.run_id,
            "cancelled_late": [late.return_code, len(late.goals)],
            "feedback": len(told),
            "of_this_goal": all(list(sample.goal_id) == goal for sample in told),
        }, ros.endpoints()
    finally:
        serving.terminate()
        serving.communicate(timeout=20)


if __name__ == "__main__":
    main()
