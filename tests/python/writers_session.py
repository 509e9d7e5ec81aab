"""Strangers that command the motor and speak for its sensors, beside the nodes that may. usage: writers_session.py FOLDER [whole]"""

import json
import math
import subprocess
import sys
import time

from diagnostic_msgs.msg import DiagnosticArray
from friction_msgs.msg import MotorVoltage
from rig_bench import CONTROLLER, PROGRAMS, RIG, Bench, seconds
from ros_calls import caller

COMMANDS, CONTROL, OBSERVE = "rig_driver: commands", "controller", "friction_observer"

# Another process, which publishes a thousand times a second until it is ended.
STRANGER = """
import sys, time, rclpy
from friction_msgs.msg import FrictionEstimate, MotorVoltage, Reference
from sensor_msgs.msg import JointState
what, ahead = sys.argv[1], float(sys.argv[2])
rclpy.init()
node = rclpy.create_node("stranger")
message, topic = {
    "voltage": (MotorVoltage(voltage=6.0), "/motor_voltage"),
    "nan": (MotorVoltage(voltage=float("nan")), "/motor_voltage"),
    "joints": (JointState(name=["load_shaft"], position=[0.0], velocity=[-9.0], effort=[0.0]), "/joint_states"),
    "estimate": (FrictionEstimate(model="x", torque=0.9), "/friction_estimate"),
    "reference": (Reference(velocity=-3.0), "/reference"),
}[what]
publisher = node.create_publisher(type(message), topic, 10)
begin, sent = time.monotonic(), 0
while True:
    if what != "reference":
        at = time.time() + ahead
        message.header.stamp.sec, message.header.stamp.nanosec = (int(at), int(at % 1 * 1e9)) if ahead else (0, 0)
    publisher.publish(message)
    sent += 1
    time.sleep(max(0.0, begin + sent * 1e-3 - time.monotonic()))
"""


class Stranger:
    def __init__(self, what, ahead):
        self.process = subprocess.Popen([sys.executable, "-c", STRANGER, what, str(ahead)])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()


class Health:
    """What the nodes tell of themselves."""

    def __init__(self, ros):
        self.ros, self.told = ros, {}
        self.keep = ros.node.create_subscription(DiagnosticArray, "/diagnostics", self.hear, 100)

    def hear(self, message):
        for status in message.status:
            values = {value.key: value.value for value in status.values}
            self.told.setdefault(status.name, []).append((int.from_bytes(status.level, "little"), status.message, values))

    def last(self, name):
        return self.told.get(name, [(-1, "", {})])[-1]

    def error(self, name, word, patience=12.0):
        """What a node says of itself as an error with a word, once it does."""
        self.told.pop(name, None)
        def found():
            return next((text for level, text, _ in self.told.get(name, []) if level == 2 and word in text), "")
        self.ros.until(lambda: found(), patience)
        return found()

    def fine(self, name, patience=8.0):
        self.told.pop(name, None)
        return self.ros.until(lambda: name in self.told and self.last(name)[0] == 0, patience)


def attacked(ros, bench, health, what, ahead, name):
    """The loop at 1 rad/s while a stranger publishes: whether the node says so, and what the shaft does."""
    with Stranger(what, ahead):
        said = health.error(name, "/stranger")
        bench.forget()
        begin = time.time()
        bench.hear(1.5)
        heard = bench.after(begin)
        report = {
            "said": said,
            "heard": len(heard),
            "highest": max((abs(m.voltage_asked) for m in heard), default=math.inf),
            "state": ros.state(RIG),
            "moves": bench.moves(1.0, 5),
        }
    report["fine"] = health.fine(name)
    return report


def strangers(ros, bench, health, whole):
    """Beside the genuine controller, at 1 rad/s."""
    bench.velocity = 1.0
    bench.start(*PROGRAMS[:2])
    # On a busy machine this script may be held up: its reference is not to be taken for one that ended.
    bench.start("controller", arguments=("-p", "reference_timeout:=10.0"))
    report = {"moves": bench.moves(1.0, 30)}
    ros.until(lambda: health.last(COMMANDS)[2].get("/motor_voltage is taken from", "nobody") != "nobody", 10)
    report["commander"] = health.last(COMMANDS)[2].get("/motor_voltage is taken from", "")
    attacks = [("voltage", 10.0, COMMANDS), ("nan", 0.0, COMMANDS), ("joints", 1e-6, CONTROL), ("reference", 0.0, CONTROL)]
    if whole:
        attacks += [("voltage", 0.0, COMMANDS), ("joints", 10.0, OBSERVE), ("estimate", 1e-6, CONTROL)]
    for what, ahead, name in attacks:
        report[f"{what} {ahead}"] = attacked(ros, bench, health, what, ahead, name)
    # The genuine one loses nothing: as many commands as cycles, but for what a busy machine loses.
    controls = [int(values["commands"]) for _, _, values in health.told.get(CONTROL, [])]
    report["commands"] = controls[-3:]
    return report


def twin(ros, bench, health):
    """A second driver in another process."""
    process = bench.programs.start("rig_driver")
    said = health.error(COMMANDS, "second node /rig_driver")
    ros.spin(1.5)
    code, took, words = bench.programs.end(process)
    return {"first says": said, "second says": words[-4000:], "code": code, "goes on": bench.moves(1.0, 10)}


def invented(ros, bench, health):
    """The one who commands, with stamps that no measurement has."""
    bench.velocity = None
    bench.end("controller")
    ros.until(lambda: ros.state(RIG) == "inactive", 5)
    node = ros.node
    voltage = node.create_publisher(MotorVoltage, "/motor_voltage", 100)
    # It keeps the rig awake; a stamp of zero means now.
    awake = node.create_timer(0.01, lambda: voltage.publish(MotorVoltage(voltage=0.0)))
    ros.spin(0.7)
    report = {"active": bench.clear_and_activate()}
    ros.spin(0.2)

    def send(later_ns, times=100):
        bench.forget()
        begin = time.time()
        for _ in range(times):
            ros.until(lambda: bench.measured, 2)
            message = MotorVoltage(voltage=6.0)
            stamp = bench.measured[-1].header.stamp
            at = stamp.sec * 10**9 + stamp.nanosec + later_ns
            message.header.stamp.sec, message.header.stamp.nanosec = at // 10**9, at % 10**9
            voltage.publish(message)
            ros.spin(0.004)
        bench.hear(0.2)
        return bench.highest(begin)

    report["never measured"] = send(-1)
    report["from the future"] = send(10 * 10**9)
    report["long ago"] = send(-20 * 10**9)
    health.told.clear()
    ros.until(lambda: COMMANDS in health.told, 5)
    report["told"] = health.last(COMMANDS)[2]
    report["measured"] = send(0)
    report["state"] = ros.state(RIG)
    # Two before an activation: none is preferred, but one may be named.
    ros.change(RIG, "deactivate")
    with Stranger("voltage", 0.0) as stranger:
        # The driver has to hear both, on a busy machine seconds after they are there.
        both = lambda: health.last(COMMANDS)[2].get("/motor_voltage is heard from", "").count("(GUID ") == 2
        report["both"] = ros.until(both, 30)
        report["refused"] = ros.change(RIG, "activate")
        report["named"] = [ros.set(RIG, commander="/caller")[0], ros.change(RIG, "activate")]
        bench.forget()
        begin = time.time()
        bench.hear(1.0)
        report["with a name"] = [ros.state(RIG), bench.highest(begin)]
        report["relative"] = ros.set(RIG, commander="caller")[0]
        assert stranger.process.poll() is None
    awake.cancel()
    return report


def main() -> None:
    with caller(fast=True) as ros, Bench(ros, sys.argv[1]) as bench:
        health = Health(ros)
        report = {"strangers": strangers(ros, bench, health, sys.argv[2:] == ["whole"]), "twin": twin(ros, bench, health), "invented": invented(ros, bench, health)}
        report["said"] = bench.end("rig_driver")[2][-20_000:]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
