"""Asks nodes for their types (`~/get_type_description`), beside a node of rclpy, and hears what they say of their parameters when they start.

usage: described_session.py FOLDER_OF_PROGRAMS FRICTIONLAB STARTS

Prints as JSON: what each node answers for the hash of each of its endpoints, whether that is what ROS generated for the type, and of so many starts those
at which a listener that was there heard all parameters.
"""

import json
import sys
import tempfile
from pathlib import Path

from friction_msgs.action import RunExperiment
from processes import Processes
from rcl_interfaces.msg import ParameterEvent
from rclpy.action import ActionServer
from ros_calls import SIGNAL, caller
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from type_description_interfaces.srv import GetTypeDescription

STOCK = "/stock"
RUNNER = "/experiment_runner"
# Their files are those of ROS in fewer words.
OWN = "friction_msgs/"


def generated():
    """Descriptions and hashes that ROS generated, by the names of the types."""
    types = {}
    for file in Path(sys.prefix).glob("share/*/*/*.json"):
        read = json.loads(file.read_text(encoding="utf-8"))
        if "type_description_msg" in read:
            for one in read["type_hashes"]:
                types[one["type_name"]] = {"hash": one["hash_string"]}
            whole = read["type_description_msg"]
            types[whole["type_description"]["type_name"]]["description"] = whole
    return types


def plain(message):
    """A message as dictionaries and lists."""
    if hasattr(message, "get_fields_and_field_types"):
        return {name: plain(getattr(message, name)) for name in message.get_fields_and_field_types()}
    return [plain(one) for one in message] if isinstance(message, list) else message


class Asker:
    def __init__(self, ros):
        self.ros = ros
        self.generated = generated()

    def ask(self, node, name, hash_string, sources=True):
        request = GetTypeDescription.Request(type_name=name, type_hash=hash_string, include_type_sources=sources)
        return self.ros.call(GetTypeDescription, f"{node}/get_type_description", request)

    def used(self, node):
        """Types of the node's endpoints, as the graph shows them, with the hash where the graph shows it."""
        graph, name = self.ros.node, node.lstrip("/")
        shown = {}
        for by_node, info in (
            (graph.get_publisher_names_and_types_by_node, graph.get_publishers_info_by_topic),
            (graph.get_subscriber_names_and_types_by_node, graph.get_subscriptions_info_by_topic),
        ):
            for topic, kinds in by_node(name, "/"):
                for one in info(topic):
                    if one.node_name == name:
                        shown[one.topic_type] = str(one.topic_type_hash)
        for _, kinds in graph.get_service_names_and_types_by_node(name, "/"):
            shown.update({kind: None for kind in kinds if kind not in shown})
        return shown

    def node(self, node):
        """For each type: what is wrong with the answer, nothing if it is right."""
        report = {}
        for name, shown in sorted(self.used(node).items()):
            known = self.generated[name]
            if shown not in (None, known["hash"]):
                report[name] = f"the graph shows {shown}"
                continue
            answer = self.ask(node, name, known["hash"])
            expected = known.get("description")
            told = plain(answer.type_description)
            if not answer.successful:
                report[name] = answer.failure_reason
            elif expected is not None and told != expected:
                report[name] = f"{told}, not {expected}"
            elif not answer.type_sources or answer.type_sources[0].type_name != name:
                report[name] = f"sources: {[one.type_name for one in answer.type_sources]}"
            else:
                report[name] = None
        return report

    def same(self, node, name):
        """Whether a node answers what the one of rclpy does, and what differs. Texts are compared where ours are those of ROS."""
        answers = [plain(self.ask(of, name, self.generated[name]["hash"])) for of in (node, STOCK)]
        for answer in answers:
            for source in answer["type_sources"]:
                if not source["type_name"].startswith(OWN):
                    del source["raw_file_contents"]
        ours, theirs = answers
        return [key for key in theirs if ours.get(key) != theirs[key]] if theirs["successful"] else [theirs["failure_reason"]]


def starts(folder, count):
    """Of so many starts of a node, those at which all its parameters were told to a listener that was there."""
    heard = []
    with caller("listener") as ros:
        events = []
        ros.node.create_subscription(ParameterEvent, "/parameter_events", events.append, SIGNAL)
        ros.spin(0.5)
        for _ in range(count):
            events.clear()
            with Processes(folder) as programs:
                observer = programs.start("friction_observer")
                ros.until(lambda: [e for e in events if e.node == "/friction_observer" and e.new_parameters], 15)
                programs.end(observer)
            new = [{p.name for p in e.new_parameters} for e in events if e.node == "/friction_observer" and e.new_parameters]
            heard.append(len(new) == 1 and {"model", "use_sim_time", "start_type_description_service"} <= new[0])
    return heard


def main() -> None:
    folder, frictionlab, count = sys.argv[1:]
    with caller("asker") as ros, tempfile.TemporaryDirectory() as out, Processes(folder) as programs:
        import rclpy

        stock = rclpy.create_node(STOCK.lstrip("/"))
        executor = rclpy.executors.SingleThreadedExecutor()
        executor.add_node(stock)
        executor.add_node(ros.node)
        ros.executor = executor
        keep = [
            stock.create_publisher(JointState, "/of_stock", 10),
            stock.create_service(Trigger, "~/trigger", lambda _, answer: answer),
            ActionServer(stock, RunExperiment, "~/run", lambda _: None),
        ]
        nodes = ["/rig_driver", "/friction_observer", "/controller", RUNNER]
        for node in nodes[:3]:
            programs.start(node.lstrip("/"))
        programs.run(frictionlab, "serve", "--runs", out)
        assert ros.until(lambda: set(nodes) <= set(ros.nodes()), 40), ros.nodes()
        # Endpoints follow the nodes' names.
        ros.spin(3)
        asker = Asker(ros)
        kind = "sensor_msgs/msg/JointState"
        own = asker.generated[kind]["hash"]
        reason = lambda node, hash_string: asker.ask(node, kind, hash_string).failure_reason
        bad = ["", "RIHS01_00", "RIHS01_" + "0" * 64]
        report = {
            "nodes": {node: asker.node(node) for node in [STOCK, *nodes]},
            "same": {
                "/rig_driver": asker.same("/rig_driver", kind) + asker.same("/rig_driver", "std_srvs/srv/Trigger"),
                RUNNER: asker.same(RUNNER, "friction_msgs/action/RunExperiment"),
            },
            "refused": [[reason(node, hash_string) for hash_string in bad] for node in (STOCK, "/rig_driver")],
            "without_sources": len(asker.ask("/rig_driver", kind, own, sources=False).type_sources),
        }
        del keep
        executor.remove_node(stock)
        stock.destroy_node()
        executor.remove_node(ros.node)
    report["starts"] = starts(folder, int(count))
    print(json.dumps(report))


if __name__ == "__main__":
    main()
