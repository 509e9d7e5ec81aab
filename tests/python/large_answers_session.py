"""Asks every service and the action of every node for the largest answer that it has, and sends and hears large messages of topics.

Answers are noted by the service's name: the bytes of the answer and the seconds it took, or why there is none.

usage: large_answers_session.py FOLDER_OF_PROGRAMS FRICTIONLAB RUNS [MODEL ...]

An experiment is run and identified with the models that are named; without any the runner is only asked what there is.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

from friction_msgs.action import RunExperiment
from friction_msgs.msg import FrictionEstimate, Setting
from friction_msgs.srv import Identify, ListExperiments, StartExperiment
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from processes import Processes, there
from rcl_interfaces.msg import Log, Parameter, ParameterEvent, ParameterType
from rcl_interfaces.srv import DescribeParameters, GetParameters, GetParameterTypes, ListParameters, SetParameters, SetParametersAtomically
from rclpy.action import ActionClient
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from ros_calls import SIGNAL, caller, value
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from type_description_interfaces.srv import GetTypeDescription

MANAGED = ("rig_driver", "friction_observer", "controller")
NODES = (*MANAGED, "experiment_runner")
PATIENCE = 15.0
LATCHED = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# A question as long as Fast DDS sends it in several packets.
TEXT = "x" * 4000
EXPERIMENT = "velocity-tracking"


class Asker:
    def __init__(self, ros):
        self.ros = ros
        self.answers = {}

    def note(self, name, answer, asked, missing="no answer"):
        self.answers[name] = missing if answer is None else [len(serialize_message(answer)), round(time.monotonic() - asked, 3)]
        return answer

    def ask(self, kind, name, request, of=""):
        asked = time.monotonic()
        try:
            return self.note(name + of, self.ros.call(kind, name, request, PATIENCE), asked)
        except RuntimeError as error:
            return self.note(name + of, None, asked, str(error))

    def parameters(self, node):
        """What `ros2 param list`, `dump`, `describe` and `load` ask, of all parameters at a time."""
        listed = self.ask(ListParameters, f"{node}/list_parameters", ListParameters.Request())
        if listed is None:
            return
        names = listed.result.names
        got = self.ask(GetParameters, f"{node}/get_parameters", GetParameters.Request(names=names))
        self.ask(GetParameterTypes, f"{node}/get_parameter_types", GetParameterTypes.Request(names=names))
        described = self.ask(DescribeParameters, f"{node}/describe_parameters", DescribeParameters.Request(names=names))
        if got is None or described is None:
            return
        again = [Parameter(name=name, value=was) for name, was, of in zip(names, got.values, described.descriptors) if not of.read_only]
        self.ask(SetParameters, f"{node}/set_parameters", SetParameters.Request(parameters=again))
        self.ask(SetParametersAtomically, f"{node}/set_parameters_atomically", SetParametersAtomically.Request(parameters=again))
        # A text is taken up to 4096 bytes; what is wrong with this one is told.
        texts = [name for name, was in zip(names, got.values) if was.type == ParameterType.PARAMETER_STRING]
        long = [Parameter(name=name, value=value(TEXT)) for name in texts]
        self.ask(SetParameters, f"{node}/set_parameters", SetParameters.Request(parameters=long), " of long texts")

    def type_of_parameters(self, node):
        """What the largest type is that every node uses, with the texts of its files."""
        generated = Path(sys.prefix) / "share/rcl_interfaces/srv/SetParameters.json"
        [of_type, *_] = json.loads(generated.read_text(encoding="utf-8"))["type_hashes"]
        request = GetTypeDescription.Request(type_name=of_type["type_name"], type_hash=of_type["hash_string"])
        answer = self.ask(GetTypeDescription, f"{node}/get_type_description", request)
        if answer is not None and not answer.successful:
            self.answers[f"{node}/get_type_description"] = answer.failure_reason

    def lifecycle(self, node):
        """What `ros2 lifecycle` asks."""
        self.ask(GetState, f"{node}/get_state", GetState.Request())
        self.ask(GetAvailableStates, f"{node}/get_available_states", GetAvailableStates.Request())
        for which in ("get_available_transitions", "get_transition_graph"):
            self.ask(GetAvailableTransitions, f"{node}/{which}", GetAvailableTransitions.Request())
        for label in ("deactivate", "activate"):
            self.ask(ChangeState, f"{node}/change_state", ChangeState.Request(transition=Transition(label=label)))

    def run(self, *models):
        """One experiment by the action, with feedback, and its result twice."""
        action = ActionClient(self.ros.node, RunExperiment, "/experiment_runner/run_experiment")
        name, feedback = "/experiment_runner/run_experiment", []
        if not action.wait_for_server(timeout_sec=PATIENCE):
            self.answers[name] = "no action"
            return None
        self.ros.spin(0.2)
        overrides = [Setting(name="quick", value="true"), Setting(name="seed", value="1")]
        goal = RunExperiment.Goal(experiment=EXPERIMENT, models=list(models), repetitions=1, overrides=overrides)
        asked = time.monotonic()
        handle = self.wait(action.send_goal_async(goal, feedback_callback=feedback.append))
        if handle is None or not handle.accepted:
            self.answers[name + " goal"] = "not accepted"
            return None
        answer = self.note(name + " result", self.wait(handle.get_result_async(), 120.0), asked)
        asked = time.monotonic()
        self.note(name + " result again", self.wait(handle.get_result_async()), asked)
        self.answers[name + " feedback"] = [len(feedback), 0.0] if feedback else "no feedback"
        asked = time.monotonic()
        self.note(name + " cancel", self.wait(handle.cancel_goal_async()), asked)
        return None if answer is None else answer.result

    def wait(self, future, seconds=PATIENCE):
        self.ros.until(future.done, seconds)
        return future.result() if future.done() else None


def experiments(asker, models):
    asker.ask(ListExperiments, "/experiment_runner/list_experiments", ListExperiments.Request())
    done = asker.run(*models) if models else None
    if done is None:
        asker.ask(Identify, "/experiment_runner/identify", Identify.Request(bag_path="no_" + TEXT))
    else:
        assert done.success, done.message
        request = Identify.Request(bag_path=f"{done.run_id}/bag", models=list(models), overrides=[Setting(name="no-joint", value="true")])
        asked = time.monotonic()
        future = asker.ros.node.create_client(Identify, "/experiment_runner/identify").call_async(request)
        asker.note("/experiment_runner/identify", asker.wait(future, 120.0), asked)
    asker.ask(StartExperiment, "/experiment_runner/start_experiment", StartExperiment.Request(experiment="no " + TEXT))
    asker.ask(Trigger, "/experiment_runner/abort", Trigger.Request())


def unasked(ros, answers):
    """Services of the programs that were not asked."""
    own = tuple(f"/{node}/" for node in NODES)
    offered = [name for name, _ in ros.node.get_service_names_and_types() if name.startswith(own)]
    return [name for name in offered if "/_action/" not in name and name not in answers]


def dropped(device="card"):
    """Packets that the programs' machine could not send because too many waited."""
    if not there():
        return 0
    told = subprocess.run([*there(), "tc", "-s", "-j", "qdisc", "show", "dev", device], capture_output=True, text=True, check=True)
    return sum(queue.get("drops", 0) for queue in json.loads(told.stdout))


def large_joint_states(ros):
    """The observer hears the laboratory's joint among 150 others: bytes of the message, and whether an estimate follows what only this message says."""
    heard = []
    estimates = ros.node.create_subscription(FrictionEstimate, "/friction_estimate", heard.append, SIGNAL)
    publisher = ros.node.create_publisher(JointState, "/joint_states", SIGNAL)
    others = [f"joint_{number:04}_of_a_large_robot" for number in range(150)]
    message = JointState(name=[*others, "load_shaft"], position=[0.0] * 151, velocity=[0.0] * 150 + [7.5], effort=[0.0] * 151)

    def followed():
        message.header.stamp = ros.node.get_clock().now().to_msg()
        publisher.publish(message)
        return any(abs(estimate.velocity - 7.5) < 1.0 for estimate in heard)

    ros.until(lambda: publisher.get_subscription_count() > 0)
    arrived = ros.until(followed, PATIENCE)
    ros.node.destroy_subscription(estimates)
    ros.node.destroy_publisher(publisher)
    return [len(serialize_message(message)), arrived]


def main() -> None:
    folder, frictionlab, runs, *models = sys.argv[1:]
    with caller() as ros, Processes(folder) as programs:
        events, logs = [], []
        ros.node.create_subscription(ParameterEvent, "/parameter_events", events.append, 1000)
        ros.node.create_subscription(Log, "/rosout", logs.append, LATCHED)
        for program in MANAGED:
            programs.start(program)
        programs.run(frictionlab, "serve", "--runs", runs)
        asker = Asker(ros)
        for node in NODES:
            asker.parameters(f"/{node}")
            asker.type_of_parameters(f"/{node}")
        for node in MANAGED:
            asker.lifecycle(f"/{node}")
        for name in ("controller/reset", "friction_observer/reset", "rig_driver/zero_sensors", "rig_driver/emergency_stop", "rig_driver/clear_fault"):
            asker.ask(Trigger, f"/{name}", Trigger.Request())
        experiments(asker, models)
        report = {"unasked": unasked(ros, asker.answers)}
        # What a question of some kilobytes can ask for.
        asker.ask(GetParameters, "/friction_observer/get_parameters", GetParameters.Request(names=["model"] * 2000), " repeated")
        report["answers"] = asker.answers
        ros.spin(0.5)
        report["largest_event"] = max((len(serialize_message(event)) for event in events), default=0)
        report["logged"] = len(logs)
        report["dropped"] = dropped()
        report["joint_states"] = large_joint_states(ros)
        report["exit"] = [programs.end(program)[0] for program in list(programs.running)]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
