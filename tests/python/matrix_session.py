"""Whether nodes are served over one middleware: topic, service, parameter, lifecycle, action, each true or why not.

usage: matrix_session.py FOLDER_OF_PROGRAMS FRICTIONLAB MIDDLEWARE, which is `fast_dds` (with rclpy) or `cyclone` (with cyclonedds, in the way of rmw_cyclonedds)
"""

import contextlib
import json
import os
import sys
from pathlib import Path

from processes import Processes

OBSERVER = "/friction_observer"


def tried(what) -> "bool | str":
    """What came of it: true, or why not."""
    try:
        came = what()
        return True if came is True else f"{what.__name__}: {came}"
    except Exception as error:
        return f"{what.__name__}: {type(error).__name__}: {error}"


@contextlib.contextmanager
def over_fast_dds():
    from friction_msgs.action import RunExperiment
    from friction_msgs.msg import ControllerState, Reference, Setting
    from rclpy.action import ActionClient
    from ros_calls import SIGNAL, caller
    from sensor_msgs.msg import JointState

    with caller() as ros:

        def topic():
            heard, followed = [], []
            keep = [
                ros.node.create_subscription(JointState, "/joint_states", heard.append, SIGNAL),
                ros.node.create_subscription(ControllerState, "/controller_state", lambda s: followed.append(s.reference), SIGNAL),
            ]
            publisher = ros.node.create_publisher(Reference, "/reference", SIGNAL)

            def exchanged():
                publisher.publish(Reference(velocity=0.125))
                return len(heard) > 100 and 0.125 in followed

            good = ros.until(exchanged, 30)
            [ros.node.destroy_subscription(one) for one in keep]
            return good or f"{len(heard)} joint states heard, reference followed: {0.125 in followed}"

        def service():
            return ros.trigger(f"{OBSERVER}/reset")[0]

        def parameter():
            listed = ros.list(OBSERVER).names
            good = ros.set(OBSERVER, injection=1.5)[0]
            bad = ros.set(OBSERVER, injection=1e9)[0]
            return (len(listed) > 10 and good[0] and not bad[0] and ros.get(OBSERVER, "injection") == [1.5]) or [len(listed), good, bad]

        def lifecycle():
            seen = [ros.state(OBSERVER)]
            for label in ("deactivate", "activate"):
                ros.change(OBSERVER, label)
                seen.append(ros.state(OBSERVER))
            return seen == ["active", "inactive", "active"] or seen

        def action():
            client, feedback = ActionClient(ros.node, RunExperiment, "/experiment_runner/run_experiment"), []
            if not client.wait_for_server(timeout_sec=30):
                return "no action"
            ros.spin(0.2)
            overrides = [Setting(name="quick", value="true")]
            goal = RunExperiment.Goal(experiment="pre-sliding", models=["lugre"], repetitions=1, overrides=overrides)
            sent = client.send_goal_async(goal, feedback_callback=feedback.append)
            if not ros.until(sent.done, 30) or not sent.result().accepted:
                return "not accepted"
            result = sent.result().get_result_async()
            if not ros.until(result.done, 120):
                return "no result"
            return (result.result().result.success and bool(feedback)) or [result.result().result.message, len(feedback)]

        yield topic, service, parameter, lifecycle, action


@contextlib.contextmanager
def over_cyclone():
    import cyclone_session as session
    from cyclone_ros import Ros

    ros = Ros(session.DOMAIN)

    def topic():
        came = session.topics(ros)
        return came["exchanged"] or came

    def service():
        answer = {"success": bool, "message": str}
        return ros.client(OBSERVER + "/reset", "std_srvs/srv/Trigger", None, answer).wait().call().success

    def parameter():
        came = session.parameters(ros)
        return (came["listed"] > 10 and came["values"] == [0.0, 1.5] and [good for good, _ in came["set"]] == [True, False]) or came

    def lifecycle():
        came = session.lifecycle(ros)
        return came["states"] == ["active", "inactive", "active"] or came

    def action():
        came, _ = session.action(ros)
        return (came["accepted"] and came["result"][1] and came["feedback"] > 0) or came

    yield topic, service, parameter, lifecycle, action


def main() -> None:
    folder, frictionlab, middleware = sys.argv[1:]
    over = {"fast_dds": over_fast_dds, "cyclone": over_cyclone}[middleware]
    with over() as calls, Processes(folder) as programs:
        for program in ("rig_driver", "friction_observer", "controller"):
            programs.start(program)
        report = {}
        for call in calls:
            # Over Cyclone DDS the session starts the runner itself.
            if call.__name__ == "action" and middleware == "fast_dds":
                programs.run(frictionlab, "serve", "--runs", str(Path(os.environ["ROS_LOG_DIR"]) / "runs"))
            report[call.__name__] = tried(call)
    print(json.dumps(report))


if __name__ == "__main__":
    main()
