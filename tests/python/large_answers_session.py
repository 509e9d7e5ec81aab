"""Asks every service and action of every node for the largest answer that it has.

usage: large_answers_session.py FOLDER_OF_PROGRAMS FRICTIONLAB RUNS
"""

import json
import sys
import time

from friction_msgs.srv import ListExperiments
from lifecycle_msgs.srv import GetAvailableStates, GetAvailableTransitions
from processes import Processes
from rcl_interfaces.srv import DescribeParameters, GetParameters, GetParameterTypes, ListParameters
from rclpy.serialization import serialize_message
from ros_calls import caller

NODES = ("rig_driver", "friction_observer", "controller")
PATIENCE = 15.0


class Asker:
    """Asks, and notes the size of each answer [bytes] and how long it took [s]."""

    def __init__(self, ros):
        self.ros = ros
        self.answers = {}

    def ask(self, kind, name, request):
        asked = time.monotonic()
        try:
            answer = self.ros.call(kind, name, request, PATIENCE)
        except RuntimeError as error:
            self.answers[name] = str(error)
            return None
        self.answers[name] = [len(serialize_message(answer)), time.monotonic() - asked]
        return answer

    def parameters(self, node):
        listed = self.ask(ListParameters, f"{node}/list_parameters", ListParameters.Request())
        if listed is None:
            return
        names = listed.result.names
        self.ask(GetParameters, f"{node}/get_parameters", GetParameters.Request(names=names))
        self.ask(GetParameterTypes, f"{node}/get_parameter_types", GetParameterTypes.Request(names=names))
        self.ask(DescribeParameters, f"{node}/describe_parameters", DescribeParameters.Request(names=names))

    def lifecycle(self, node):
        self.ask(GetAvailableStates, f"{node}/get_available_states", GetAvailableStates.Request())
        for which in ("get_available_transitions", "get_transition_graph"):
            self.ask(GetAvailableTransitions, f"{node}/{which}", GetAvailableTransitions.Request())


def main() -> None:
    folder, frictionlab, runs = sys.argv[1:]
    with caller() as ros, Processes(folder) as programs:
        for program in NODES:
            programs.start(program)
        programs.run(frictionlab, "serve", "--runs", runs)
        asker = Asker(ros)
        for node in NODES:
            asker.parameters(f"/{node}")
        for node in NODES:
            asker.lifecycle(f"/{node}")
        asker.ask(ListExperiments, "/experiment_runner/list_experiments", ListExperiments.Request())
        print(json.dumps(asker.answers))


if __name__ == "__main__":
    main()
