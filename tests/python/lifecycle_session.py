"""What `ros2 lifecycle` does, on the rig: it moves in active only. usage: lifecycle_session.py FOLDER"""

import json
import signal
import struct
import sys
import time

from friction_msgs.msg import MotorVoltage, RigMeasurement
from lifecycle_msgs.msg import TransitionEvent
from processes import Processes
from ros_calls import SIGNAL, caller

RIG = "/rig_driver"


def main() -> None:
    with caller() as ros, Processes(sys.argv[1]) as programs:
        report = {}
        seen, events = [], []
        keep = [
            ros.node.create_subscription(RigMeasurement, "/rig_measurement", seen.append, SIGNAL),
            ros.node.create_subscription(TransitionEvent, f"{RIG}/transition_event", events.append, 100),
        ]
        voltage = ros.node.create_publisher(MotorVoltage, "/motor_voltage", 100)
        volts = [0.0]

        def command():
            # A stamp of zero counts as made now.
            voltage.publish(MotorVoltage(voltage=volts[0]))

        commands = ros.node.create_timer(0.002, command)
        rig = programs.start("rig_driver", "-p", "autostart:=false", "-p", "safety.command_age:=0.1")

        def moved(seconds=0.6):
            """The largest voltage, the travel and the fault flag in the next moments, by the measurements' own stamps."""
            begin = time.time() + 0.2
            seen.clear()
            stamp = lambda m: m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec
            ros.until(lambda: seen and stamp(seen[-1]) > begin + seconds, 8)
            fresh = [m for m in seen if begin < stamp(m) <= begin + seconds]
            if not fresh:
                return [0.0, 0.0, False]
            return [
                max(abs(m.voltage_applied) for m in fresh),
                abs(fresh[-1].encoder_position - fresh[0].encoder_position),
                fresh[-1].fault,
            ]

        # The same services of the real library, to compare with.
        from rclpy.lifecycle import LifecycleNode

        real = LifecycleNode("real")
        from rclpy.executors import SingleThreadedExecutor
        import threading

        executor = SingleThreadedExecutor()
        executor.add_node(real)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        report["same_states"] = ros.states(RIG) == ros.states("/real")
        ours, theirs = ros.transitions(RIG, "get_transition_graph"), ros.transitions("/real", "get_transition_graph")
        report["graph"] = [sorted(ours), sorted(theirs)]
        available = {}

        def compare(label):
            available[label] = [sorted(ros.transitions(RIG)), sorted(ros.transitions("/real"))]

        report["walk"] = [ros.state(RIG)]
        compare("unconfigured")
        report["bad_label"] = ros.change(RIG, "activate")
        report["bad_number"] = ros.change(RIG, number=99)
        volts[0] = 3.0
        report["walk"].append([ros.change(RIG, "configure"), ros.state(RIG)])
        ros.change("/real", "configure")
        compare("inactive")
        report["inactive"] = moved()
        report["walk"].append([ros.change(RIG, number=3), ros.state(RIG)])
        ros.change("/real", "activate")
        compare("active")
        report["active"] = moved()
        report["walk"].append([ros.change(RIG, "deactivate"), ros.state(RIG)])
        report["deactivated"] = moved()
        report["available"] = available
        # zero, emergency stop, clear
        volts[0] = 0.0
        ros.spin(0.5)
        report["zero"] = ros.trigger(f"{RIG}/zero_sensors")
        ros.change(RIG, "activate")
        report["zero_while_active"] = ros.trigger(f"{RIG}/zero_sensors")
        volts[0] = 3.0
        report["before_stop"] = moved()
        report["stop"] = ros.trigger(f"{RIG}/emergency_stop")
        report["stopped"] = moved()
        report["state_stopped"] = ros.state(RIG)
        report["activate_stopped"] = ros.change(RIG, "activate")
        report["clear"] = ros.trigger(f"{RIG}/clear_fault")
        report["state_cleared"] = ros.state(RIG)
        seen.clear()
        ros.spin(1.0)
        seen.clear()
        ros.spin(0.5)
        report["cleared"] = len(seen)
        # a voltage that is no number
        ros.change(RIG, "configure"), ros.change(RIG, "activate")
        ros.spin(0.2)
        voltage.publish(MotorVoltage(voltage=float("nan")))
        report["nan"] = moved()
        report["state_nan"] = ros.state(RIG)
        report["clear_nan"] = ros.trigger(f"{RIG}/clear_fault")
        report["again"] = [ros.change(RIG, "activate"), ros.state(RIG)]
        report["moves_again"] = moved()
        # bytes that are no message
        raw = struct.pack("<I", 0xFFFFFFFF) * 3
        for payload in (b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + raw, b"\xff" * 40):
            voltage.publish(payload)
        ros.spin(0.3)
        report["after_garbage"] = [ros.state(RIG), moved()]
        # commands from long ago
        volts[0] = 0.0
        ros.spin(0.3)
        old = MotorVoltage(voltage=5.0)
        old.header.stamp.sec = 1_000_000_000
        ros.node.create_timer(0.002, lambda: voltage.publish(old))
        report["old"] = moved()
        # commands that stop coming
        timers = list(ros.node.timers)
        for timer in timers:
            timer.cancel()
        report["silent"] = moved(1.2)
        report["state_silent"] = ros.until(lambda: ros.state(RIG) == "inactive", 5)
        report["shutdown"] = [ros.change(RIG, "shutdown"), ros.state(RIG)]
        ros.spin(0.2)
        report["events"] = [[e.transition.id, e.start_state.label, e.goal_state.label] for e in events]
        ros.until(lambda: RIG in ros.nodes(), 5)
        present = RIG in ros.nodes()
        started = time.monotonic()
        rig.send_signal(signal.SIGINT)
        gone = ros.until(lambda: RIG not in ros.nodes(), 10)
        report["leaving"] = [present, gone, time.monotonic() - started]
        code, took, said = programs.end(rig)
        report["exit"] = [code, time.monotonic() - started, said]
        report["keep"] = len(keep)
        executor.shutdown()
        thread.join()
        real.destroy_node()
        print(json.dumps(report))


if __name__ == "__main__":
    main()
