"""The loop for a long time: memory, losses, drift. Prints them as JSON.

usage: soak_session.py FOLDER SECONDS processes
       soak_session.py FOLDER SECONDS live PROGRAM

FOLDER has the programs of the nodes, PROGRAM is frictionlab.
"""

import glob
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import time

from diagnostic_msgs.msg import DiagnosticArray
from friction_msgs.msg import MotorVoltage, Reference, RigMeasurement
from processes import Processes
from rig_bench import PROGRAMS, resident_kilobytes
from ros_calls import SIGNAL, caller

PERIOD_NS = 1_000_000
NO_STAMP = -1


class Heard:
    """What a subscriber of a signal of 1 kHz heard, without keeping it."""

    def __init__(self):
        self.count = 0
        self.first = self.last = NO_STAMP
        self.first_cycle = self.last_cycle = 0
        self.missing = self.disordered = 0
        # Smallest delay from stamp to wall clock in the first and in the present second [ns].
        self.first_delay = self.delay = None
        self.second = self.before = None

    def take(self, stamp, cycle=None):
        now = time.time_ns()
        if self.count == 0:
            self.first, self.first_cycle = stamp, cycle
        elif stamp <= self.last:
            self.disordered += 1
        elif cycle is not None:
            self.missing += cycle - self.last_cycle - 1
        self.count += 1
        self.last, self.last_cycle = stamp, cycle
        if self.second != now // 1_000_000_000:
            if self.first_delay is None and self.count > 100:
                self.first_delay = self.delay
            self.second, self.before, self.delay = now // 1_000_000_000, self.delay, now - stamp
        self.delay = min(self.delay, now - stamp)

    def drift(self):
        """How much the stamps gained on the wall clock, over the time."""
        last = self.delay if self.before is None else min(self.delay, self.before)
        return ((self.first_delay or last) - last) / max(1, self.last - self.first)


def stamp_ns(message):
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def memory(pids):
    return {name: resident_kilobytes(pid) for name, pid in pids.items()}


def settle(ros, seconds, pids, report):
    """Runs for the time; memory is read after a minute, or a fifth of the time, and at the end."""
    early = min(60.0, seconds / 5)
    ros.spin(early)
    report["memory_early_kb"], report["early_s"] = memory(pids), early
    ros.spin(seconds - early)
    report["memory_end_kb"] = memory(pids)
    growth = lambda name: report["memory_end_kb"][name] / report["memory_early_kb"][name] - 1
    report["memory_growth"] = {name: growth(name) for name in pids}


def follow(ros, programs, seconds):
    rig, commands = Heard(), Heard()
    health = {}

    def look(message):
        for status in message.status:
            seen = health.setdefault(status.name, {"commands": 0})
            values = {value.key: value.value for value in status.values}
            seen["commands"] += int(values.get("commands", 0))
            seen.update({key: value for key, value in values.items() if key != "commands"})

    keep = [
        ros.node.create_subscription(RigMeasurement, "/rig_measurement", lambda m: rig.take(stamp_ns(m), m.cycle), SIGNAL),
        ros.node.create_subscription(MotorVoltage, "/motor_voltage", lambda m: commands.take(stamp_ns(m)), SIGNAL),
        ros.node.create_subscription(DiagnosticArray, "/diagnostics", look, 100),
    ]
    publisher = ros.node.create_publisher(Reference, "/reference", 10)
    start = time.monotonic()

    def refer():
        t = time.monotonic() - start
        publisher.publish(Reference(velocity=1.5 * math.sin(3 * t), position=0.5 * (1 - math.cos(3 * t)), acceleration=4.5 * math.cos(3 * t)))

    ros.node.create_timer(0.01, refer)
    pids = {name: programs.start(name).pid for name in PROGRAMS}
    assert ros.until(lambda: commands.count > 500, 30), "the loop does not close"
    # What follows begins with everybody there.
    rig.__init__(), commands.__init__(), health.clear()
    report = {"mode": "processes"}
    settle(ros, seconds, pids, report)
    report["heard"], report["commands_heard"] = rig.count, commands.count
    report["missing_at_subscriber"], report["disordered"] = rig.missing, rig.disordered
    cycles = rig.last_cycle - rig.first_cycle
    report["cycles"] = cycles
    report["commands_missing"] = round((commands.last - commands.first) / PERIOD_NS) + 1 - commands.count
    report["cycles_against_stamps"] = cycles * PERIOD_NS / (rig.last - rig.first) - 1
    report["stamps_against_wall_clock"] = rig.drift()
    report["health"] = health
    report["keep"] = len(keep)
    report["exit"] = [list(programs.end(process)[:2]) for process in list(programs.running)]
    return report


def live(ros, program, seconds):
    joints = Heard()
    from sensor_msgs.msg import JointState

    keep = ros.node.create_subscription(JointState, "/joint_states", lambda m: joints.take(stamp_ns(m)), SIGNAL)
    report = {"mode": "live"}
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "run")
        with open(os.path.join(folder, "said"), "w+", encoding="utf-8") as said:
            running = subprocess.Popen(
                [program, "live", "--duration", str(seconds + 5), "--amplitude", "1.5", "--frequency", "3", "--out", out],
                stdout=said,
                stderr=subprocess.STDOUT,
            )
            try:
                assert ros.until(lambda: joints.count > 500 or running.poll() is not None, 30), "nothing is heard"
                joints.__init__()
                settle(ros, seconds, {"frictionlab live": running.pid}, report)
                assert ros.until(lambda: running.poll() is not None, 60), "it does not end"
            finally:
                if running.poll() is None:
                    running.send_signal(signal.SIGINT)
                    running.wait(timeout=20)
            said.seek(0)
            report["said"] = said.read()[-3000:]
        report["exit"] = [[running.returncode, 0.0]]
        report["heard"], report["disordered"] = joints.count, joints.disordered
        report["missing_at_subscriber"] = round((joints.last - joints.first) / PERIOD_NS) + 1 - joints.count
        report["stamps_against_wall_clock"] = joints.drift()
        report["bag"] = bag(out)
    report["keep"] = keep is not None
    return report


def bag(folder):
    """Cycles of the bag's joint states that are missing, by their stamps."""
    from mcap.reader import make_reader

    stamps = []
    for path in glob.glob(os.path.join(folder, "**", "*.mcap"), recursive=True):
        with open(path, "rb") as file:
            stamps += [message.log_time for _, _, message in make_reader(file).iter_messages(topics=["/joint_states"])]
    if len(stamps) < 2:
        return {"messages": len(stamps), "missing": None}
    return {"messages": len(stamps), "missing": round((stamps[-1] - stamps[0]) / PERIOD_NS) + 1 - len(stamps)}


def main() -> None:
    folder, seconds, mode, *rest = sys.argv[1:]
    with caller("soak", fast=True) as ros, Processes(folder) as programs:
        report = follow(ros, programs, float(seconds)) if mode == "processes" else live(ros, rest[0], float(seconds))
        print(json.dumps(report))


if __name__ == "__main__":
    main()
