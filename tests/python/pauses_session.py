"""Each process of the loop stands still for a second (SIGSTOP) and goes on. usage: pauses_session.py FOLDER"""

import json
import signal
import sys
import time

from friction_msgs.msg import MotorVoltage
from rig_bench import PROGRAMS, RIG, Bench, seconds
from ros_calls import caller

PAUSE = 1.0


def stands_still(bench, name):
    ros = bench.ros
    bench.forget()
    ros.spin(0.3)
    process = bench.running[name]
    process.send_signal(signal.SIGSTOP)
    stopped = time.time()
    ros.spin(PAUSE)
    last = max((seconds(m) for m in bench.commands), default=0.0)
    told = {"last_voltage": bench.last_voltage() - last, "fault_before": bench.first_fault(stopped) > 0.0}
    process.send_signal(signal.SIGCONT)
    awake = time.time()
    # Long enough to begin anew.
    ros.spin(1.2)
    told["fault"] = bench.first_fault(stopped) > 0.0
    told["voltage_after"] = bench.highest(awake + 0.002)
    told["cycles_after"] = len(bench.after(awake))
    told["state"] = ros.state(RIG)
    heard = bench.after(stopped - 0.2)
    told["fastest"] = max(abs(m.tachometer_velocity) for m in heard)
    told["steepest"] = max((abs(b.encoder_position - a.encoder_position) for a, b in zip(heard, heard[1:]) if seconds(b) - seconds(a) < 0.0015), default=0.0)
    # A rig driver that saw its commands lost before it began anew waits for people.
    told["again"] = (
        [ros.change(RIG, "configure"), ros.change(RIG, "activate")] if told["state"] == "unconfigured" else None
    )
    told["cleared"] = bench.clear_and_activate() if told["fault"] else None
    told["moves_again"] = bench.moves(1.0)
    return told


def main() -> None:
    with caller(fast=True) as ros, Bench(ros, sys.argv[1]) as bench:
        bench.velocity = 1.0
        bench.start(*PROGRAMS)
        report = {"moves": bench.moves(1.0, 30)}
        for name in PROGRAMS:
            report[name] = stands_still(bench, name)
        # References that nobody heard while there was no rig are of no use when it comes back.
        bench.end("rig_driver", signal.SIGKILL)
        ros.spin(1.5)
        bench.velocity = None
        ros.spin(1.0)
        bench.forget()
        begin = time.time()
        bench.start("rig_driver")
        ros.until(lambda: bench.measured, 10)
        report["heard_again"] = bench.hear(0.6)
        report["old_references"] = bench.travel(begin)
        # Commands without a stamp that wait in a socket while the rig driver stands still.
        bench.velocity = 1.0
        report["moves_with_new"] = bench.moves(1.0)
        bench.end("controller")
        ros.until(lambda: ros.state(RIG) == "inactive", 5)
        bench.clear_and_activate()
        voltage = ros.node.create_publisher(MotorVoltage, "/motor_voltage", 100)
        ros.spin(0.5)
        process = bench.running["rig_driver"]
        for _ in range(50):
            voltage.publish(MotorVoltage(voltage=2.0))
            ros.spin(0.002)
        bench.hear(0.1)
        report["unstamped_moves"] = bench.highest(begin)
        ros.spin(1.0)
        report["again"] = bench.clear_and_activate()
        bench.hear(0.2)
        process.send_signal(signal.SIGSTOP)
        for _ in range(50):
            voltage.publish(MotorVoltage(voltage=3.0))
            time.sleep(0.002)
        time.sleep(0.4)
        process.send_signal(signal.SIGCONT)
        awake = time.time()
        bench.hear(0.4)
        # A process stops some time after the signal: what came before is on the motor until its first
        # cycle afterwards, which measures it.
        under = [m.voltage_applied for m in bench.after(awake) if m.voltage_applied != 0.0]
        report["old_unstamped"] = under
        report["exit"] = [list(bench.end(name)[:2]) for name in ("rig_driver", "friction_observer")]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
