"""Readers of every topic, each in a process of its own: some keep up, some are slow, frozen, killed or gone from the network."""

import ctypes
import json
import mmap
import os
import signal
import struct
import sys
import time
import traceback

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from friction_msgs.msg import ControllerState, ExperimentStatus, FrictionEstimate, MotorVoltage, Reference, RigMeasurement
from lifecycle_msgs.msg import TransitionEvent
from rcl_interfaces.msg import Log, ParameterEvent
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

# Once a cycle, each from one writer, with a header in front.
SIGNALS = {
    "/joint_states": JointState,
    "/rig_measurement": RigMeasurement,
    "/motor_voltage": MotorVoltage,
    "/friction_estimate": FrictionEstimate,
    "/controller_state": ControllerState,
}
# Now and then.
OTHERS = {
    "/reference": Reference,
    "/diagnostics": DiagnosticArray,
    "/experiment_status": ExperimentStatus,
    "/rosout": Log,
    "/parameter_events": ParameterEvent,
    "/rig_driver/transition_event": TransitionEvent,
    "/friction_observer/transition_event": TransitionEvent,
    "/controller/transition_event": TransitionEvent,
}
TOPICS = SIGNALS | OTHERS
WINDOW_NS = 500_000_000
CLONE_NEWNET = 0x40000000
PR_SET_PDEATHSIG = 1
LIBC = ctypes.CDLL(None, use_errno=True)


def end_with_parent():
    """The calling process is killed when its parent is gone, however that ends."""
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def quality(depth=0, best_effort=False):
    """Keeps everything if `depth` is zero."""
    return QoSProfile(
        depth=depth or 1,
        history=HistoryPolicy.KEEP_LAST if depth else HistoryPolicy.KEEP_ALL,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.VOLATILE,
    )


def take(subscription):
    """The next message and what is said of it, without a wait set: an executor would take most of a processor for these topics."""
    with subscription.handle:
        return subscription.handle.take_message(subscription.msg_type, subscription.raw)


class Watched:
    """A topic as a reader heard it."""

    def __init__(self):
        self.count = self.lost = self.disordered = 0
        self.first = self.last = self.sequence = None
        self.longest_gap_ns = 0
        self.windows = set()
        self.delays = []
        self.began = time.time_ns()

    def take(self, data, info):
        sequence = info["publication_sequence_number"]
        sec, nanosec = struct.unpack_from("<iI", data, 4)
        stamp = sec * 1_000_000_000 + nanosec
        if self.sequence is not None:
            if sequence <= self.sequence:
                self.disordered += 1
            else:
                self.lost += sequence - self.sequence - 1
            self.longest_gap_ns = max(self.longest_gap_ns, stamp - self.last)
        self.first, self.last, self.sequence = self.first or stamp, stamp, sequence
        self.count += 1
        # By the time of arrival here, not of reading: this process may have to wait for its turn. What
        # comes late in one go leaves windows empty.
        self.windows.add(info["received_timestamp"] // WINDOW_NS)
        self.delays.append(info["received_timestamp"] - info["source_timestamp"])

    def report(self):
        # The first and the last one are not whole.
        silent = sum(window not in self.windows for window in range(self.began // WINDOW_NS + 1, time.time_ns() // WINDOW_NS))
        delays = sorted(self.delays) or [0]
        at = lambda share: delays[int(share * (len(delays) - 1))] / 1000
        return {
            "count": self.count,
            "lost": self.lost,
            "disordered": self.disordered,
            "silent_windows": silent,
            "seconds": (self.last - self.first) / 1e9 if self.first else 0.0,
            "longest_gap_s": self.longest_gap_ns / 1e9,
            "delay_p50_us": at(0.5),
            "delay_p99_us": at(0.99),
            "delay_max_us": delays[-1] / 1000,
        }


class Healthy:
    """Keeps up with every topic, gives the reference, and hears what the nodes say of themselves."""

    def __init__(self, name):
        self.node = rclpy.create_node(name)
        self.subscriptions = [
            (topic, self.node.create_subscription(kind, topic, lambda _: None, quality(5000), raw=topic in SIGNALS))
            for topic, kind in TOPICS.items()
        ]
        self.reference = self.node.create_publisher(Reference, "/reference", 10)
        self.begin()

    def begin(self):
        """Forgets what was."""
        self.watched = {topic: Watched() for topic in SIGNALS}
        self.said, self.health, self.faults, self.cycles = [], {}, 0, []
        self.others = {topic: 0 for topic in OTHERS}

    def hear(self):
        for topic, subscription in self.subscriptions:
            while (taken := take(subscription)) is not None:
                data, info = taken
                if topic in SIGNALS:
                    self.watched[topic].take(data, info)
                    if topic == "/rig_measurement" and (self.watched[topic].count % 20 == 0 or not self.cycles):
                        measured = deserialize_message(data, RigMeasurement)
                        self.faults += measured.fault
                        self.cycles.append(measured.cycle)
                    continue
                self.others[topic] += 1
                if topic == "/rosout":
                    self.said.append(f"{data.name}: {data.msg}")
                elif topic == "/diagnostics":
                    for status in data.status:
                        self.health[status.name] = {value.key: value.value for value in status.values} | {"message": status.message}

    def refer(self):
        t = time.monotonic()
        velocity = 1.5 if t % 2 < 1 else -1.5
        self.reference.publish(Reference(velocity=velocity))

    def report(self):
        return {
            "topics": {topic: watched.report() for topic, watched in self.watched.items()},
            "others": self.others,
            "faults": self.faults,
            "cycles": self.cycles[-1] - self.cycles[0] if self.cycles else 0,
            "health": self.health,
            "said": self.said,
        }

    def run(self, orders, answers, refers):
        """Follows `orders`, one word a line: `begin` and `report`."""
        os.set_blocking(orders, False)
        pending = b""
        while True:
            if refers:
                self.refer()
            self.hear()
            time.sleep(0.005)
            try:
                read = os.read(orders, 4096)
            except BlockingIOError:
                continue
            if not read:
                return
            pending += read
            *lines, pending = pending.split(b"\n")
            for line in lines:
                if line == b"report":
                    os.write(answers, json.dumps(self.report()).encode() + b"\n")
                self.begin()


def sick(name, kind, heard):
    """Hears everything as `kind` says, and counts it in `heard`, memory that the parent sees."""
    node = rclpy.create_node(name)
    best_effort, slow = kind == "best_effort", kind == "slow"
    wanted = quality(0 if slow else 100, best_effort)
    subscriptions = [node.create_subscription(kind, topic, lambda _: None, wanted, raw=True) for topic, kind in TOPICS.items()]
    while True:
        for subscription in subscriptions:
            while take(subscription) is not None:
                heard[:8] = (int.from_bytes(heard[:8], "little") + 1).to_bytes(8, "little")
                if slow:
                    break
        time.sleep(0.05 if slow else 0.01)


def healthy_reader(name, refers):
    return Child(name, lambda orders, answers: Healthy(name).run(orders, answers, refers))


def sick_reader(name, kind, network=None):
    heard = mmap.mmap(-1, 8)
    child = Child(name, lambda orders, answers: sick(name, kind, heard), network)
    child.kind = kind
    child.heard = lambda: int.from_bytes(heard[:8], "little")
    return child


class Child:
    """A process of its own that does `run(orders, answers)` with rclpy: both are ends of pipes. It begins in the network of the process `network`, if one is given."""

    def __init__(self, name, run, network=None):
        self.name = name
        orders, self.orders = os.pipe()
        self.answers, answers = os.pipe()
        sys.stdout.flush()
        self.pid = os.fork()
        if self.pid:
            os.close(orders), os.close(answers)
            return
        # Nothing of rclpy has begun before.
        code = 1
        try:
            end_with_parent()
            os.close(self.orders), os.close(self.answers)
            if network is not None:
                other = os.open(f"/proc/{network}/ns/net", os.O_RDONLY)
                if LIBC.setns(other, CLONE_NEWNET):
                    raise OSError(ctypes.get_errno(), "setns")
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            rclpy.init()
            run(orders, answers)
            code = 0
        except Exception:
            traceback.print_exc()
        finally:
            # Not the parent's way out.
            os._exit(code)

    def order(self, word):
        os.write(self.orders, word.encode() + b"\n")

    def report(self):
        """What it heard since it began; it begins anew."""
        self.order("report")
        text = b""
        while not text.endswith(b"\n"):
            read = os.read(self.answers, 1 << 16)
            if not read:
                raise RuntimeError(f"{self.name} has ended")
            text += read
        return json.loads(text)

    def send(self, how):
        os.kill(self.pid, how)

    def end(self):
        try:
            os.kill(self.pid, signal.SIGKILL)
        except ProcessLookupError:
            return
        os.waitpid(self.pid, 0)
