"""What rcl makes of ROS arguments, by rclpy. usage: arguments_peer.py; cases come as JSON on standard input

A case is {"node": name, "arguments": [...], "topics": [...], "services": [...]}; the answer to each is the node's absolute name, the absolute
names of topics and services, and the parameters that it is given; or null if rcl refuses the arguments.
"""

import json
import sys

import rclpy
from rclpy.context import Context
from rclpy.node import Node


def answer(case):
    context = Context()
    try:
        rclpy.init(args=["program", "--ros-args", *case["arguments"]], context=context)
        node = Node(case["node"], context=context, automatically_declare_parameters_from_overrides=True, start_parameter_services=False)
    except Exception as error:
        print(f"{case['arguments']}: {error}", file=sys.stderr)
        return None
    try:
        parameters = {
            name: [parameter.type_.name, parameter.value if not hasattr(parameter.value, "tolist") else parameter.value.tolist()]
            for name, parameter in node._parameters.items()
            if name not in ("use_sim_time", "start_type_description_service")
        }
        return {
            "node": node.get_fully_qualified_name(),
            "topics": [node.resolve_topic_name(name) for name in case["topics"]],
            "services": [node.resolve_service_name(name) for name in case["services"]],
            "parameters": {
                name: [kind, list(value) if isinstance(value, (list, tuple)) or type(value).__name__ == "array" else value]
                for name, (kind, value) in parameters.items()
            },
        }
    finally:
        node.destroy_node()
        context.shutdown()


def main() -> None:
    print(json.dumps([answer(case) for case in json.load(sys.stdin)]))


if __name__ == "__main__":
    main()
