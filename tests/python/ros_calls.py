"""The calls that the verbs of `ros2` make, with rclpy: topics, services, parameters, lifecycle, graph."""

import time
from contextlib import contextmanager

import rclpy
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_srvs.srv import Trigger

SIGNAL = QoSProfile(depth=2000, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.RELIABLE)


def value(x):
    """A parameter's value from a Python one."""
    v = ParameterValue()
    if x is None:
        v.type = ParameterType.PARAMETER_NOT_SET
    elif isinstance(x, bool):
        v.type, v.bool_value = ParameterType.PARAMETER_BOOL, x
    elif isinstance(x, int):
        v.type, v.integer_value = ParameterType.PARAMETER_INTEGER, x
    elif isinstance(x, float):
        v.type, v.double_value = ParameterType.PARAMETER_DOUBLE, x
    elif isinstance(x, str):
        v.type, v.string_value = ParameterType.PARAMETER_STRING, x
    else:
        raise TypeError(x)
    return v


def plain(v):
    """A Python value from a parameter's."""
    return {
        ParameterType.PARAMETER_NOT_SET: lambda: None,
        ParameterType.PARAMETER_BOOL: lambda: v.bool_value,
        ParameterType.PARAMETER_INTEGER: lambda: v.integer_value,
        ParameterType.PARAMETER_DOUBLE: lambda: v.double_value,
        ParameterType.PARAMETER_STRING: lambda: v.string_value,
        ParameterType.PARAMETER_DOUBLE_ARRAY: lambda: list(v.double_array_value),
    }[v.type]()


class Caller:
    """A node that calls others."""

    def __init__(self, node, executor=None):
        self.node = node
        self.executor = executor
        self.clients = {}

    def once(self, seconds):
        """Hears once, at most so long."""
        rclpy.spin_once(self.node, executor=self.executor, timeout_sec=seconds)

    def spin(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.once(max(0.0, min(0.02, end - time.monotonic())))

    def until(self, condition, seconds=20.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition():
                return True
            self.once(0.02)
        return bool(condition())

    def call(self, kind, name, request, seconds=20.0):
        key = (kind, name)
        new = key not in self.clients
        if new:
            self.clients[key] = self.node.create_client(kind, name)
        client = self.clients[key]
        if not client.wait_for_service(timeout_sec=seconds):
            raise RuntimeError(f"no service {name}")
        if new:
            # What a server cannot place yet is sent again only by Fast DDS's heartbeat, every 3 s.
            self.spin(0.1)
        # A server may learn of a new client a moment after the client learns of it: ask again, as people do.
        for _ in range(3):
            future = client.call_async(request)
            rclpy.spin_until_future_complete(self.node, future, executor=self.executor, timeout_sec=seconds / 3)
            if future.done():
                return future.result()
        raise RuntimeError(f"no answer from {name}")

    def trigger(self, name):
        answer = self.call(Trigger, name, Trigger.Request())
        return [answer.success, answer.message]

    # ros2 param
    def list(self, node, prefixes=(), depth=0):
        return self.call(ListParameters, f"{node}/list_parameters", ListParameters.Request(prefixes=list(prefixes), depth=depth)).result

    def get(self, node, *names):
        return [plain(v) for v in self.call(GetParameters, f"{node}/get_parameters", GetParameters.Request(names=names)).values]

    def types(self, node, *names):
        return list(self.call(GetParameterTypes, f"{node}/get_parameter_types", GetParameterTypes.Request(names=names)).types)

    def describe(self, node, *names):
        return self.call(DescribeParameters, f"{node}/describe_parameters", DescribeParameters.Request(names=names)).descriptors

    def set(self, node, **values):
        parameters = [Parameter(name=name.replace("__", "."), value=value(x)) for name, x in values.items()]
        results = self.call(SetParameters, f"{node}/set_parameters", SetParameters.Request(parameters=parameters)).results
        return [[result.successful, result.reason] for result in results]

    def set_atomically(self, node, **values):
        parameters = [Parameter(name=name.replace("__", "."), value=value(x)) for name, x in values.items()]
        result = self.call(
            SetParametersAtomically, f"{node}/set_parameters_atomically", SetParametersAtomically.Request(parameters=parameters)
        ).result
        return [result.successful, result.reason]

    # ros2 lifecycle
    def state(self, node):
        return self.call(GetState, f"{node}/get_state", GetState.Request()).current_state.label

    def change(self, node, label="", number=0):
        request = ChangeState.Request(transition=Transition(id=number, label=label))
        return self.call(ChangeState, f"{node}/change_state", request).success

    def states(self, node):
        answer = self.call(GetAvailableStates, f"{node}/get_available_states", GetAvailableStates.Request())
        return [[state.id, state.label] for state in answer.available_states]

    def transitions(self, node, which="get_available_transitions"):
        answer = self.call(GetAvailableTransitions, f"{node}/{which}", GetAvailableTransitions.Request())
        return [
            [t.transition.id, t.transition.label, t.start_state.label, t.goal_state.label]
            for t in answer.available_transitions
        ]

    def nodes(self):
        return sorted(f"{namespace.rstrip('/')}/{name}" for name, namespace in self.node.get_node_names_and_namespaces())


@contextmanager
def caller(name="caller", fast=False, **options):
    """A node that calls others. `fast` hears several topics of 1 kHz at a time, which the default executor does not."""
    rclpy.init()
    node = rclpy.create_node(name, **options)
    executor = None
    if fast:
        from rclpy.experimental import EventsExecutor

        executor = EventsExecutor()
        executor.add_node(node)
    try:
        yield Caller(node, executor)
    finally:
        node.destroy_node()
        rclpy.shutdown()
