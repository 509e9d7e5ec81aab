"""The three programs of a loop, a reference, and a recorder of what the motor gets."""

import signal
import time

from friction_msgs.msg import ControllerState, MotorVoltage, Reference, RigMeasurement
from processes import Processes
from ros_calls import SIGNAL

PROGRAMS = ("rig_driver", "friction_observer", "controller")
RIG, OBSERVER, CONTROLLER = "/rig_driver", "/friction_observer", "/controller"


def seconds(message) -> float:
    """Stamp of a message [s]."""
    return message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec


class Bench:
    """Programs by name, and what rclpy hears of them."""

    def __init__(self, ros, folder):
        self.ros = ros
        self.programs = Processes(folder)
        self.running = {}
        self.measured, self.commands, self.states = [], [], []
        node = ros.node
        self.keep = [
            node.create_subscription(RigMeasurement, "/rig_measurement", self.measured.append, SIGNAL),
            node.create_subscription(MotorVoltage, "/motor_voltage", self.commands.append, SIGNAL),
            node.create_subscription(ControllerState, "/controller_state", self.states.append, SIGNAL),
        ]
        self.references = node.create_publisher(Reference, "/reference", 10)
        self.velocity = 0.0
        self.timer = node.create_timer(0.01, self.refer)

    def refer(self):
        if self.velocity is not None:
            self.references.publish(Reference(velocity=self.velocity))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in self.running.values():
            process.send_signal(signal.SIGCONT)
        self.programs.__exit__()

    def start(self, *names, arguments=()):
        for name in names:
            self.running[name] = self.programs.start(name, *arguments)

    def end(self, name, how=signal.SIGINT):
        """Ends one; what it said."""
        process = self.running.pop(name)
        return self.programs.end(process, how)

    def forget(self):
        for log in (self.measured, self.commands, self.states):
            log.clear()

    def moves(self, velocity, patience=15.0):
        """Whether the shaft comes to within a third of a velocity."""
        near = lambda m: abs(m.tachometer_velocity - velocity) < 0.35 * abs(velocity)
        fresh = lambda m: time.time() - seconds(m) < 0.5

        def arrived():
            last = self.measured[-20:]
            return len(last) == 20 and fresh(last[-1]) and all(near(m) for m in last)

        arrived = self.ros.until(arrived, patience)
        return bool(arrived)

    def hear(self, duration, patience=10.0):
        """Spins until the recorder has heard measurements of so many more seconds, by the clock of their stamps."""
        end = time.time() + duration
        return self.ros.until(lambda: self.measured and seconds(self.measured[-1]) > end, duration + patience)

    def after(self, moment):
        """Measurements stamped after a moment [s since the epoch]."""
        return [m for m in self.measured if seconds(m) > moment]

    def highest(self, moment):
        """Largest voltage that was applied after a moment [V]."""
        return max((abs(m.voltage_applied) for m in self.after(moment)), default=0.0)

    def travel(self, moment):
        """How far the shaft turned after a moment [rad]."""
        heard = self.after(moment)
        return abs(heard[-1].encoder_position - heard[0].encoder_position) if heard else 0.0

    def last_voltage(self):
        """Stamp of the last measurement that was under voltage [s]."""
        return max((seconds(m) for m in self.measured if m.voltage_applied != 0.0), default=0.0)

    def last_command(self):
        """Stamp of the measurement that the last command answers to [s]."""
        return max((seconds(m) for m in self.commands), default=0.0)

    def first_fault(self, moment):
        """Stamp of the first measurement after a moment whose fault flag is set [s]; 0 without."""
        return min((seconds(m) for m in self.after(moment) if m.fault), default=0.0)

    def clear_and_activate(self):
        return [self.ros.trigger(f"{RIG}/clear_fault")[0], self.ros.change(RIG, "activate")]


def resident_kilobytes(pid):
    """Resident memory of a process [kB]."""
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


__all__ = ["Bench", "CONTROLLER", "OBSERVER", "PROGRAMS", "RIG", "resident_kilobytes", "seconds"]
