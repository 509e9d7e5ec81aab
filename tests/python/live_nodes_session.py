"""The nodes of one `frictionlab live`, by the calls that `ros2` makes. usage: live_nodes_session.py PROGRAM FOLDER

The first process has its own reference and serves experiments; the second takes its reference from /reference and has arguments of ROS.
"""

import json
import math
import os
import signal
import subprocess
import sys
import time

from diagnostic_msgs.msg import DiagnosticArray
from friction_msgs.msg import ControllerState, FrictionEstimate, MotorVoltage, Reference, RigMeasurement
from friction_msgs.srv import ListExperiments
from rcl_interfaces.msg import ParameterEvent
from ros_calls import SIGNAL, caller

RIG, OBSERVER, CONTROLLER, RUNNER = "/rig_driver", "/friction_observer", "/controller", "/experiment_runner"


def stamp(message):
    return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec


class Live:
    """A running `frictionlab live`."""

    def __init__(self, program, out, *arguments):
        command = [program, "live", "--out", out, *arguments]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=os.path.dirname(out))

    def end(self):
        started = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        try:
            told, said = self.process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            told, said = self.process.communicate()
        return [self.process.returncode, time.monotonic() - started, told + said]


def main() -> None:
    program, folder = sys.argv[1:]
    report = {}
    with caller() as ros:
        measured, estimates, events, states = [], [], [], []
        health = []
        keep = [
            ros.node.create_subscription(DiagnosticArray, "/diagnostics", health.append, 100),
            ros.node.create_subscription(RigMeasurement, "/rig_measurement", measured.append, SIGNAL),
            ros.node.create_subscription(FrictionEstimate, "/friction_estimate", estimates.append, SIGNAL),
            ros.node.create_subscription(ControllerState, "/controller_state", states.append, SIGNAL),
            ros.node.create_subscription(ParameterEvent, "/parameter_events", events.append, 1000),
        ]

        def fresh(messages, seconds=0.5):
            """What is measured in the next moments, by the messages' own stamps."""
            begin = time.time() + 0.3
            messages.clear()
            ros.until(lambda: messages and stamp(messages[-1]) > begin + seconds, 8)
            return [message for message in messages if stamp(message) > begin]

        def moved(seconds=0.5):
            seen = fresh(measured, seconds)
            if not seen:
                return None
            travel = seen[-1].encoder_position - seen[0].encoder_position
            return [max(abs(m.voltage_applied) for m in seen), abs(travel)]

        # Its own reference.
        out = os.path.join(folder, "own")
        live = Live(program, out, "--model", "dahl", "--plant", "lugre", "--seed", "7", "--reference", "constant", "--amplitude", "1.5", "--serve")
        report["active"] = ros.until(lambda: measured and abs(measured[-1].voltage_applied) > 0.5, 30)
        ros.until(lambda: {RIG, OBSERVER, CONTROLLER, RUNNER} <= set(ros.nodes()), 10)
        report["nodes"] = ros.nodes()
        report["given"] = {
            "rig": ros.get(RIG, "rig", "simulated.model", "simulated.seed", "autostart"),
            "observer": ros.get(OBSERVER, "model", "mode", "technique"),
            "controller": ros.get(CONTROLLER, "mode", "compensation", "velocity_law") + ros.get(CONTROLLER, "lag.k_p"),
            "runner": ros.get(RUNNER, "runs"),
        }
        report["states"] = [ros.state(node) for node in (RIG, OBSERVER, CONTROLLER, RUNNER)]
        described = ros.describe(OBSERVER, "lugre.sigma0")[0]
        report["described"] = [described.description, described.additional_constraints]
        answer = ros.call(ListExperiments, f"{RUNNER}/list_experiments", ListExperiments.Request())
        report["experiments"] = [experiment.name for experiment in answer.experiments]
        # Parameters while it runs.
        report["models"] = [sorted({e.model for e in fresh(estimates)})]
        events.clear()
        report["set"] = ros.set(OBSERVER, model="lugre")
        report["models"].append(sorted({e.model for e in fresh(estimates)}))
        report["events"] = [[e.node, c.name, c.value.string_value] for e in events for c in e.changed_parameters]
        report["refused"] = ros.set(CONTROLLER, compensation_scale=3.0) + ros.set(OBSERVER, lugre__sigma0=-1.0)
        report["scale"] = ros.get(CONTROLLER, "compensation_scale")
        # The rig's lifecycle.
        report["moving"] = moved()
        report["deactivate"] = [ros.change(RIG, "deactivate"), ros.state(RIG)]
        ros.spin(0.5)
        report["still"] = moved()
        report["activate"] = [ros.change(RIG, "activate"), ros.state(RIG)]
        report["moving_again"] = moved()
        # The observer's.
        report["observer_off"] = [ros.change(OBSERVER, "deactivate"), ros.state(OBSERVER)]
        begin = time.time() + 0.1
        ros.until(lambda: stamp(measured[-1]) > begin + 0.5, 8)
        report["silent"] = sum(stamp(e) > begin for e in estimates)
        report["uncompensated"] = max((abs(s.friction) for s in fresh(states)), default=None)
        report["observer_on"] = ros.change(OBSERVER, "activate")
        report["reset"] = [ros.trigger(f"{node}/reset")[0] for node in (OBSERVER, CONTROLLER)]
        def commands():
            """The level and the words of what the driver tells next of its commands, and how many came from elsewhere."""
            health.clear()
            of = lambda: [status for message in health for status in message.status if status.name == "rig_driver: commands"]
            ros.until(lambda: len(of()) >= 2, 8)
            key = "commands from elsewhere while the controller in this process commands"
            last = of()[-1]
            return [int.from_bytes(last.level, "little"), last.message, {value.key: value.value for value in last.values}[key]]

        report["commands"] = [commands()]
        # Voltages from elsewhere do not count while the controller in the process commands, nor does one that is no number stop it.
        volts = [math.nan]
        voltage = ros.node.create_publisher(MotorVoltage, "/motor_voltage", 100)
        timer = ros.node.create_timer(0.005, lambda: voltage.publish(MotorVoltage(voltage=volts[0])))
        ros.spin(0.5)
        report["nan_from_elsewhere"] = [*moved(), ros.state(RIG)]
        report["commands"].append(commands())
        # Nor when it ends, until the rig is activated without it.
        volts[0] = 2.5
        report["controller_off"] = ros.change(CONTROLLER, "deactivate")
        report["nobody_inherits"] = [m.voltage_asked for m in fresh(measured)].count(2.5)
        ros.until(lambda: ros.state(RIG) == "inactive", 5)
        report["handed_over"] = [ros.trigger(f"{RIG}/clear_fault")[0], ros.change(RIG, "activate")]
        ros.spin(0.3)
        report["open_loop"] = sorted({m.voltage_asked for m in fresh(measured)})
        timer.cancel()
        report["controller_on"] = ros.change(CONTROLLER, "activate")
        ros.spin(0.5)
        if ros.state(RIG) != "active":
            ros.trigger(f"{RIG}/clear_fault")
            ros.change(RIG, "activate")
        report["closed_again"] = moved()
        # The emergency stop.
        report["stop"] = ros.trigger(f"{RIG}/emergency_stop")
        report["stopped"] = moved()
        report["activate_stopped"] = ros.change(RIG, "activate")
        report["clear"] = ros.trigger(f"{RIG}/clear_fault")
        report["configure"] = [ros.change(RIG, "configure"), ros.trigger(f"{RIG}/zero_sensors")[0], ros.change(RIG, "activate")]
        report["after_stop"] = moved()
        report["own_exit"] = live.end()

        # The reference from elsewhere.
        measured.clear()
        out = os.path.join(folder, "ros")
        live = Live(program, out, "--reference", "ros", "--ros-args", "-p", "controller:compensation_scale:=0.75")
        report["ready"] = ros.until(lambda: len(measured) > 100, 30)
        report["scale_given"] = ros.get(CONTROLLER, "compensation_scale")
        report["without_reference"] = moved()
        reference = ros.node.create_publisher(Reference, "/reference", 100)
        timer = ros.node.create_timer(0.01, lambda: reference.publish(Reference(velocity=-1.5)))
        ros.spin(1.0)
        seen = fresh(measured, 1.0)
        report["velocity"] = (seen[-1].encoder_position - seen[0].encoder_position) / (stamp(seen[-1]) - stamp(seen[0]))
        timer.cancel()
        ros.spin(1.5)
        report["reference_gone"] = moved()
        report["ros_exit"] = live.end()
        report["keep"] = len(keep)
    print(json.dumps(report))


if __name__ == "__main__":
    main()
