"""Topics, services and actions of ROS 2 over Cyclone DDS, as `rmw_cyclonedds` puts them on the wire.

Topics, types and quality of service are those of every ROS middleware. Its own are the requests and answers of services: in front of the data stand a number of the
client and a number of the request.
"""

import itertools
import os
import random
import time

os.environ.setdefault(
    "CYCLONEDDS_URI",
    '<General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces></General>',
)

from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsParticipant,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import make_idl_struct
from cyclonedds.idl.types import array, float64, int32, int64, sequence, uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

RELIABLE = Qos(
    Policy.Reliability.Reliable(duration(seconds=1)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(10),
    Policy.DataRepresentation(use_cdrv0_representation=True),
)
LATCHED = Qos(Policy.Durability.TransientLocal, base=RELIABLE)
HEADER = {"client": uint64, "number": int64}
NOTHING = {"structure_needs_at_least_one_member": uint8}


def kind(name, fields):
    """A type by its name in ROS, as in `std_srvs/srv/Trigger_Request`."""
    package, folder, of = name.split("/")
    return make_idl_struct(of + "_", f"{package}.{folder}.dds_.{of}_", fields)


def until(condition, seconds):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return bool(condition())


class Ros:
    """A participant."""

    def __init__(self, domain):
        self.participant = DomainParticipant(domain)
        self.builtin = [
            BuiltinDataReader(self.participant, kind)
            for kind in (BuiltinTopicDcpsParticipant, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription)
        ]

    def reader(self, topic, of, qos=RELIABLE):
        return DataReader(self.participant, Topic(self.participant, topic, of, qos=qos), qos=qos)

    def writer(self, topic, of, qos=RELIABLE):
        return DataWriter(self.participant, Topic(self.participant, topic, of, qos=qos), qos=qos)

    def subscription(self, topic, of, qos=RELIABLE):
        return self.reader("rt" + topic, of, qos)

    def publisher(self, topic, of, qos=RELIABLE):
        return self.writer("rt" + topic, of, qos)

    def client(self, service, of, request, response):
        return Client(self, service, of, request, response)

    def server(self, service, of, request, response):
        return Server(self, service, of, request, response)

    def participants(self):
        """What the others say in USER_DATA of themselves."""
        return [user_data(other) for other in self.builtin[0].read(100) if ours(other)]

    def endpoints(self):
        """[topic, type, what USER_DATA says] of all readers and writers of RustDDS."""
        found = [end for reader in self.builtin[1:] for end in reader.read(2000)]
        return [[end.topic_name, end.type_name, user_data(end)] for end in found if ours(end)]


def ours(who):
    # What is told of one that has left has no quality of service.
    return str(who.key).startswith("0112") and who.qos is not None


def user_data(who):
    told = [policy.data for policy in who.qos if type(policy) is Policy.Userdata]
    return bytes(told[0]).decode() if told else None


class Server:
    """Of one service."""

    def __init__(self, ros, service, of, request, response):
        self.response = kind(of + "_Response", {**HEADER, **response})
        self.reader = ros.reader(f"rq{service}Request", kind(of + "_Request", {**HEADER, **(request or NOTHING)}))
        self.writer = ros.writer(f"rr{service}Reply", self.response)

    def serve(self, answer, ended):
        """Answers with the values that `answer` makes of a request, until `ended` says so."""
        while not ended():
            for asked in self.reader.take(100):
                self.writer.write(self.response(asked.client, asked.number, *answer(asked)))
            time.sleep(0.002)


class Client:
    """Of one service."""

    def __init__(self, ros, service, of, request, response):
        self.service = service
        self.request = kind(of + "_Request", {**HEADER, **(request or NOTHING)})
        self.reader = ros.reader(f"rr{service}Reply", kind(of + "_Response", {**HEADER, **response}))
        self.writer = ros.writer(f"rq{service}Request", self.request)
        self.id = random.getrandbits(63)
        self.numbers = itertools.count(1)
        self.others = 0

    def wait(self, seconds=20):
        there = lambda: self.writer.get_matched_subscriptions() and self.reader.get_matched_publications()
        assert until(there, seconds), f"{self.service} is not there"
        return self

    def send(self, *values):
        number = next(self.numbers)
        self.writer.write(self.request(self.id, number, *(values or (0,))))
        return number

    def answer(self, number, seconds=10):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for sample in self.reader.take(100):
                if (sample.client, sample.number) == (self.id, number):
                    return sample
                self.others += 1
            time.sleep(0.002)
        raise TimeoutError(f"{self.service} did not answer")

    def call(self, *values):
        return self.answer(self.send(*values))


# The types of ROS that the sessions speak.

TIME = kind("builtin_interfaces/msg/Time", {"sec": int32, "nanosec": uint32})
STAMPED = kind("std_msgs/msg/Header", {"stamp": TIME, "frame_id": str})
JOINT_STATE = kind(
    "sensor_msgs/msg/JointState",
    {
        "header": STAMPED,
        "name": sequence[str],
        "position": sequence[float64],
        "velocity": sequence[float64],
        "effort": sequence[float64],
    },
)
REFERENCE = kind(
    "friction_msgs/msg/Reference", {"header": STAMPED, "position": float64, "velocity": float64, "acceleration": float64}
)
VALUE = kind(
    "rcl_interfaces/msg/ParameterValue",
    {
        "type": uint8,
        "bool_value": bool,
        "integer_value": int64,
        "double_value": float64,
        "string_value": str,
        "byte_array_value": sequence[uint8],
        "bool_array_value": sequence[bool],
        "integer_array_value": sequence[int64],
        "double_array_value": sequence[float64],
        "string_array_value": sequence[str],
    },
)
PARAMETER = kind("rcl_interfaces/msg/Parameter", {"name": str, "value": VALUE})
LISTED = kind("rcl_interfaces/msg/ListParametersResult", {"names": sequence[str], "prefixes": sequence[str]})
WAS_SET = kind("rcl_interfaces/msg/SetParametersResult", {"successful": bool, "reason": str})
STATE = kind("lifecycle_msgs/msg/State", {"id": uint8, "label": str})
TRANSITION = kind("lifecycle_msgs/msg/Transition", {"id": uint8, "label": str})
SETTING = kind("friction_msgs/msg/Setting", {"name": str, "value": str})
UUID = array[uint8, 16]


def double(name, value):
    return PARAMETER(name, VALUE(3, False, 0, value, "", [], [], [], [], []))
