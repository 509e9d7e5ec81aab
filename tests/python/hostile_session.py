"""Publishers that send what nobody should. usage: hostile_session.py FOLDER"""

import json
import math
import random
import signal
import struct
import subprocess
import sys
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from friction_msgs.msg import FrictionEstimate, MotorVoltage, Reference
from rclpy.serialization import serialize_message
from rig_bench import CONTROLLER, OBSERVER, PROGRAMS, RIG, Bench, seconds
from ros_calls import caller
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

NODES = (RIG, OBSERVER, CONTROLLER)
NUMBERS = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf, "1e308": 1e308, "-1e308": -1e308, "1e6": 1e6}
LONG = 1_000_000
# Measurements that show that the loop goes on, and how long they are waited for [s].
ENOUGH, PATIENCE = 200, 60.0


def stamped(message, at):
    message.header.stamp.sec, message.header.stamp.nanosec = int(at), int(at % 1 * 1e9)
    return message


class Hostile:
    def __init__(self, bench):
        self.bench, self.ros = bench, bench.ros
        node = self.ros.node
        self.reference = bench.references
        self.voltage = node.create_publisher(MotorVoltage, "/motor_voltage", 100)
        self.estimate = node.create_publisher(FrictionEstimate, "/friction_estimate", 100)
        self.joints = node.create_publisher(JointState, "/joint_states", 100)

    def during(self, send, times=20, quiet=0.3):
        """Sends often, and looks at the motor meanwhile and shortly after; brings the loop back where it has stopped."""
        bench, ros = self.bench, self.ros
        ros.spin(0.05)
        bench.forget()
        begin = time.time()
        for _ in range(times):
            send()
            ros.spin(0.005)
        bench.velocity = 0.0
        bench.hear(quiet)
        # The measurements go on, at whatever pace the machine has.
        ros.until(lambda: len(bench.measured) > ENOUGH, PATIENCE)
        told = {
            "travel": bench.travel(begin),
            "highest": bench.highest(begin),
            "not_finite": sum(not math.isfinite(m.voltage_applied) for m in bench.measured),
            "heard": len(bench.measured),
            "state": ros.state(RIG),
        }
        if told["state"] != "active":
            told["recovered"] = bench.clear_and_activate()
        return told

    def comes_back(self):
        """The loop follows a reference once more, and rests."""
        ros, bench = self.ros, self.bench
        back = [ros.trigger(f"{CONTROLLER}/reset")[0]]
        bench.velocity = 1.0
        back.append(bench.moves(1.0, 5))
        # The observer is none the worse for it.
        back.append(ros.until(lambda: bench.states and 0.05 < bench.states[-1].friction < 2.0, 2))
        bench.velocity = 0.0
        ros.spin(0.8)
        return back


def numbers(it):
    """No numbers, and numbers that nothing can be."""
    report = {}
    for name, x in NUMBERS.items():
        report[f"reference {name}"] = it.during(lambda: it.reference.publish(Reference(velocity=x, position=x, acceleration=x)))
        report[f"estimate {name}"] = it.during(lambda: it.estimate.publish(stamped(FrictionEstimate(model="x", torque=x), time.time())))
        report[f"estimate of next year {name}"] = it.during(
            lambda: it.estimate.publish(stamped(FrictionEstimate(model="x", torque=x), time.time() + 3e7))
        )
        report[f"joints {name}"] = it.during(
            lambda: it.joints.publish(stamped(JointState(name=["load_shaft"], position=[x], velocity=[x], effort=[x]), time.time()))
        )
        report[f"comes back {name}"] = it.comes_back()
    report["voltage 1e308"] = it.during(lambda: it.voltage.publish(stamped(MotorVoltage(voltage=1e308), time.time())))
    report["voltage nan"] = it.during(lambda: it.voltage.publish(MotorVoltage(voltage=math.nan)))
    report["voltage inf"] = it.during(lambda: it.voltage.publish(MotorVoltage(voltage=-math.inf)))
    report["comes back voltage"] = it.comes_back()
    return report


def forms(it):
    """Messages of the right type that say nothing usable, and stamps of other times."""
    empty = JointState()
    names_only = JointState(name=["load_shaft"])
    short = JointState(name=["a", "load_shaft"], position=[9.0], velocity=[9.0])
    # Wrong by name: without one of that name the first is taken, so these are no joint of ours only by their numbers.
    long = JointState(name=["x" * LONG], position=[], velocity=[])
    many = JointState(name=["n"] * 100_000, position=[0.0] * 10, velocity=[])
    other = JointState(name=["elbow"], position=[5.0], velocity=[5.0], effort=[5.0])
    report = {}
    for name, message, times in (
        ("empty", empty, 20), ("names only", names_only, 20), ("short", short, 20), ("long", long, 5), ("many", many, 5), ("other", other, 20)
    ):
        report[f"joints {name}"] = it.during(lambda: it.joints.publish(stamped(message, time.time())), times)
    # A model's name of a megabyte beside an ordinary torque.
    report["estimate long"] = it.during(lambda: it.estimate.publish(FrictionEstimate(model="m" * LONG)), 5)
    report["voltage past"] = it.during(lambda: it.voltage.publish(stamped(MotorVoltage(voltage=6.0), time.time() - 60)))
    report["voltage 1970"] = it.during(lambda: it.voltage.publish(stamped(MotorVoltage(voltage=6.0), 1)))
    negative = MotorVoltage(voltage=6.0)
    negative.header.stamp.sec = -2_000_000_000
    report["voltage before 1970"] = it.during(lambda: it.voltage.publish(negative))
    report["comes back"] = it.comes_back()
    return report


def bytes_of(it):
    """Beginnings of messages, messages with changed bytes, and noise, on every topic that is listened to."""
    dice = random.Random(6)
    sound = {
        it.reference: Reference(velocity=0.0),
        it.voltage: stamped(MotorVoltage(voltage=0.0), 1),
        it.estimate: stamped(FrictionEstimate(model="lugre", torque=0.0), 1),
        it.joints: stamped(JointState(name=["load_shaft"], position=[0.0], velocity=[0.0], effort=[0.0]), 1),
    }
    cases = []
    for publisher, message in sound.items():
        whole = bytes(serialize_message(message))
        cases += [(publisher, whole[:length]) for length in range(len(whole))]
        for _ in range(100):
            cases.append((publisher, bytes(dice.randrange(256) for _ in range(dice.randrange(64)))))
        # Lengths that promise gigabytes.
        for at in range(4, len(whole) - 3, 4):
            cases.append((publisher, whole[:at] + struct.pack("<I", 0xFFFF_FFF0) + whole[at + 4 :]))
    dice.shuffle(cases)
    report = {}
    for part in range(4):
        some = iter(cases[part::4])
        count = len(cases[part::4])
        report[f"bytes {part}"] = it.during(lambda: it_publish(next(some)), count)
    report["cases"] = len(cases)
    report["comes back"] = it.comes_back()
    return report


def it_publish(case):
    publisher, data = case
    publisher.publish(data)


def another_type(it):
    """The same topic with another type, by another participant."""
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("other_type", context=context)
    publishers = [node.create_publisher(Float64, topic, 10) for topic in ("/motor_voltage", "/reference", "/joint_states", "/friction_estimate")]
    it.ros.spin(0.5)
    told = it.during(lambda: [p.publish(Float64(data=6.0)) for p in publishers], 50)
    node.destroy_node()
    rclpy.shutdown(context=context)
    return told


FLOOD = """
import sys, time, rclpy
from friction_msgs.msg import MotorVoltage, Reference
from rclpy.serialization import serialize_message
rclpy.init()
node = rclpy.create_node("flood")
kind, topic, message = {
    "reference": (Reference, "/reference", Reference(velocity=0.0)),
    "voltage": (MotorVoltage, "/motor_voltage", MotorVoltage(voltage=6.0)),
}[sys.argv[1]]
if sys.argv[1] == "voltage":
    message.header.stamp.sec = 1_000_000_000
data = bytes(serialize_message(message))
publisher = node.create_publisher(kind, topic, 10)
while publisher.get_subscription_count() == 0:
    time.sleep(0.01)
print("floods", flush=True)
begin, sent = time.monotonic(), 0
while sent < 15_000:
    for _ in range(10):
        publisher.publish(data)
    sent += 10
    # Ten thousand a second, where the machine can.
    time.sleep(max(0.0, begin + sent * 1e-4 - time.monotonic()))
print(sent)
"""


def floods(it):
    report = {}
    for which in ("reference", "voltage"):
        running = subprocess.Popen([sys.executable, "-c", FLOOD, which], stdout=subprocess.PIPE, text=True)
        assert running.stdout.readline() == "floods\n"
        begin = time.time()
        it.bench.forget()
        state = it.ros.state(RIG)
        it.ros.until(lambda: len(it.bench.measured) > ENOUGH, PATIENCE)
        report[which] = {"state": state, "travel": it.bench.travel(begin), "highest": it.bench.highest(begin), "heard": len(it.bench.measured)}
        sent, _ = running.communicate(timeout=PATIENCE)
        report[which]["sent"] = int(sent)
        it.ros.spin(0.3)
    report["comes back"] = it.comes_back()
    return report


def requests(it):
    """Requests that cannot be granted."""
    ros = it.ros
    huge = "x" * LONG
    return {
        "unknown": {node: ros.set(node, no_such=1.0)[0] for node in NODES},
        "huge value": {
            RIG: ros.set(RIG, torque_source=huge)[0], OBSERVER: ros.set(OBSERVER, model=huge)[0], CONTROLLER: ros.set(CONTROLLER, mode=huge)[0]
        },
        "huge name": {node: ros.set(node, **{huge: 1.0})[0] for node in NODES},
        "type": {
            RIG: ros.set(RIG, voltage_limit="six")[0], OBSERVER: ros.set(OBSERVER, injection=True)[0], CONTROLLER: ros.set(CONTROLLER, fade="long")[0]
        },
        "range": {
            RIG: ros.set(RIG, voltage_limit=1e9)[0], OBSERVER: ros.set(OBSERVER, share=-1.0)[0], CONTROLLER: ros.set(CONTROLLER, compensation_scale=9.0)[0]
        },
        "transition": [[ros.change(node, huge), ros.change(node, "explode"), ros.change(node, number=77)] for node in NODES],
        "get huge": [ros.get(node, huge) for node in NODES],
        "states": [ros.state(node) for node in NODES],
    }


PARTS = {"numbers": numbers, "forms": forms, "bytes": bytes_of, "another_type": another_type, "floods": floods, "requests": requests}


def main() -> None:
    folder, *parts = sys.argv[1:]
    with caller(fast=True) as ros, Bench(ros, folder) as bench:
        health = []
        bench.keep.append(ros.node.create_subscription(DiagnosticArray, "/diagnostics", health.append, 100))
        bench.velocity = 1.0
        bench.start(*PROGRAMS)
        report = {"moves": bench.moves(1.0, 30)}
        bench.velocity = 0.0
        it = Hostile(bench)
        for node in NODES:
            ros.state(node)
        ros.spin(1.0)
        for part in parts or PARTS:
            report[part] = PARTS[part](it)
        report["again"] = it.comes_back()
        report["health"] = {
            status.name: {value.key: value.value for value in status.values} for message in health for status in message.status
        }
        report["exit"] = []
        for name in PROGRAMS:
            code, took, said = bench.end(name, signal.SIGINT)
            report["exit"].append([code, took])
            report[f"said {name}"] = said[-20_000:]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
