"""Three processes follow a reference that rclpy publishes; prints how well.

usage: loop_session.py FOLDER SECONDS
"""

import json
import math
import sys
import time

from friction_msgs.msg import ControllerState, MotorVoltage, Reference, RigMeasurement
from processes import Processes
from ros_calls import SIGNAL, caller

AMPLITUDE, FREQUENCY = 1.5, 3.0


def main() -> None:
    folder, seconds = sys.argv[1], float(sys.argv[2])
    with caller("reference") as ros, Processes(folder) as programs:
        states, measured, voltages = [], [], []
        keep = [
            ros.node.create_subscription(ControllerState, "/controller_state", states.append, SIGNAL),
            ros.node.create_subscription(RigMeasurement, "/rig_measurement", measured.append, SIGNAL),
            ros.node.create_subscription(MotorVoltage, "/motor_voltage", voltages.append, SIGNAL),
        ]
        publisher = ros.node.create_publisher(Reference, "/reference", 10)
        for program in ("rig_driver", "friction_observer", "controller"):
            programs.start(program, "-p", "model:=proposed") if program == "friction_observer" else programs.start(program)
        assert ros.until(lambda: len(voltages) > 100, 30), "the loop does not close"
        start = time.monotonic()

        def send():
            t = time.monotonic() - start
            velocity = AMPLITUDE * math.sin(FREQUENCY * t)
            position = AMPLITUDE / FREQUENCY * (1 - math.cos(FREQUENCY * t))
            acceleration = AMPLITUDE * FREQUENCY * math.cos(FREQUENCY * t)
            publisher.publish(Reference(position=position, velocity=velocity, acceleration=acceleration))

        timer = ros.node.create_timer(0.001, send)
        ros.spin(1.0)
        for log in (states, measured, voltages):
            log.clear()
        ros.spin(seconds)
        timer.cancel()
        tracked = list(states)
        # The reference stops: the loop comes to rest by itself.
        assert ros.until(lambda: states and abs(states[-1].reference) < 1e-9, 5)
        ros.spin(0.3)
        at_rest = abs(measured[-1].tachometer_velocity)
        ended = [programs.end(process) for process in list(programs.running)]
        errors = [state.error for state in tracked]
        print(
            json.dumps(
                {
                    "cycles": len(tracked),
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
