"""Three processes follow a reference that rclpy publishes; prints how well.

usage: loop_session.py FOLDER SECONDS
"""

import json
import math
import sys
import time

from diagnostic_msgs.msg import DiagnosticArray
from friction_msgs.msg import ControllerState, Reference, RigMeasurement
from processes import Processes
from ros_calls import SIGNAL, caller

AMPLITUDE, FREQUENCY = 1.5, 3.0


def main() -> None:
    folder, seconds = sys.argv[1], float(sys.argv[2])
    with caller("reference") as ros, Processes(folder) as programs:
        # Python hears one signal of 1 kHz at a time; how many there were the programs' own diagnostics say.
        states, measured, health = [], [], []
        keep = [
            ros.node.create_subscription(ControllerState, "/controller_state", states.append, SIGNAL),
            ros.node.create_subscription(DiagnosticArray, "/diagnostics", health.append, 100),
        ]
        publisher = ros.node.create_publisher(Reference, "/reference", 10)
        for program in ("rig_driver", "friction_observer", "controller"):
            programs.start(program, "-p", "model:=proposed") if program == "friction_observer" else programs.start(program)
        assert ros.until(lambda: len(states) > 100, 30), "the loop does not close"
        start = time.monotonic()

        def send():
            t = time.monotonic() - start
            velocity = AMPLITUDE * math.sin(FREQUENCY * t)
            position = AMPLITUDE / FREQUENCY * (1 - math.cos(FREQUENCY * t))
            acceleration = AMPLITUDE * FREQUENCY * math.cos(FREQUENCY * t)
            publisher.publish(Reference(position=position, velocity=velocity, acceleration=acceleration))

        timer = ros.node.create_timer(0.002, send)
        ros.spin(1.0)
        for log in (states, health):
            log.clear()
        ros.spin(seconds)
        timer.cancel()
        tracked = list(states)
        # The reference stops: the loop comes to rest by itself.
        assert ros.until(lambda: states and abs(states[-1].reference) < 1e-9, 5)
        values = {}
        for status in (status for message in health for status in message.status):
            values.setdefault(status.name, []).append({value.key: value.value for value in status.values})
        keep.append(ros.node.create_subscription(RigMeasurement, "/rig_measurement", measured.append, SIGNAL))
        assert ros.until(lambda: len(measured) > 300, 10)
        at_rest = abs(measured[-1].tachometer_velocity)
        ended = [programs.end(process) for process in list(programs.running)]
        errors = [state.error for state in tracked]
        print(
            json.dumps(
                {
                    "heard": len(tracked),
                    "commands": [int(one["commands"]) for one in values["controller"]][1:-1],
                    "ages": [
                        [float(one["command age p50 [us]"]), float(one["command age p99 [us]"])]
                        for one in values["rig_driver: control loop"]
                    ][1:-1],
                    "rms_error": math.sqrt(sum(e * e for e in errors) / max(1, len(errors))),
                    "rms_reference": math.sqrt(sum(s.reference**2 for s in tracked) / max(1, len(tracked))),
                    "friction_used": sum(abs(s.friction) > 0.05 for s in tracked),
                    "at_rest": at_rest,
                    "faults": sum(m.fault for m in measured),
                    "exit": [[code, took] for code, took, _ in ended],
                    "said": "".join(said for _, _, said in ended),
                    "keep": len(keep),
                }
            )
        )


if __name__ == "__main__":
    main()
