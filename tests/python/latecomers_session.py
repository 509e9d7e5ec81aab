"""Who comes late: subscribers, clients, nodes. usage: latecomers_session.py FOLDER FRICTIONLAB"""

import json
import signal
import subprocess
import sys
import tempfile
import time

import rclpy
from friction_msgs.msg import ExperimentStatus, FrictionEstimate, MotorVoltage
from friction_msgs.srv import ListExperiments, StartExperiment
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from rig_bench import CONTROLLER, OBSERVER, PROGRAMS, RIG, Bench
from ros_calls import Caller, caller

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
RUNNER = "/experiment_runner"
ORDERS = [PROGRAMS, PROGRAMS[1:] + PROGRAMS[:1], PROGRAMS[2:] + PROGRAMS[:2]]


def newcomer(ask):
    """Asks from a participant of its own that joins now; the answer and how long it took with the joining [s]."""
    context = rclpy.Context()
    rclpy.init(context=context)
    executor = SingleThreadedExecutor(context=context)
    node = rclpy.create_node("newcomer", context=context)
    executor.add_node(node)
    began = time.monotonic()
    try:
        answer = ask(Caller(node, executor))
    finally:
        took = time.monotonic() - began
        executor.remove_node(node)
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown(context=context)
    return [answer, took]


def last_status(ros):
    """What `ros2 topic echo --once` shows: the first that comes."""
    heard = []
    keep = ros.node.create_subscription(ExperimentStatus, "/experiment_status", heard.append, LATCHED)
    ros.until(lambda: heard, 10)
    return heard[0].message if heard and keep else None


def runner(program):
    """The runner is killed and comes back; the last status reaches whoever comes late."""
    report = {}
    with tempfile.TemporaryDirectory() as runs:
        for how in (signal.SIGKILL, signal.SIGINT):
            running = subprocess.Popen([program, "serve", "--runs", runs], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            try:
                ask = lambda ros: len(ros.call(ListExperiments, f"{RUNNER}/list_experiments", ListExperiments.Request()).experiments)
                told = {"experiments": newcomer(ask)[0]}
                start = StartExperiment.Request(experiment="velocity-tracking", models=["lugre"], repetitions=1)
                told["started"] = newcomer(lambda ros: ros.call(StartExperiment, f"{RUNNER}/start_experiment", start).success)[0]
                if how == signal.SIGKILL:
                    time.sleep(0.3)
                else:
                    complete = lambda ros: ros.until(lambda: "is complete" in (last_status(ros) or ""), 60)
                    told["complete"] = newcomer(complete)[0]
                    told["status"] = newcomer(last_status)[0]
            finally:
                running.send_signal(how)
                _, said = running.communicate(timeout=30)
            told["code"], told["said"] = running.returncode, said[-2000:]
            report[signal.Signals(how).name] = told
    return report


def orders(bench):
    """Each of the three nodes comes last, when the others have settled."""
    report = {}
    for order in ORDERS:
        bench.forget()
        for name in order:
            bench.start(name)
            bench.ros.spin(0.3)
        report[" ".join(order)] = bench.moves(1.0, 15)
        if order != ORDERS[-1]:
            for name in order:
                bench.end(name)
    return report


def nodes(bench):
    """Clients and subscribers that come when the loop has run for a while."""
    report = {}

    def settled(node):
        def ask(ros):
            # The axis moves without the observer: the one that came last may still be on its way.
            ros.until(lambda: ros.state(node) == "active", 15)
            return [ros.state(node), *ros.get(node, "autostart")]

        return ask

    for node in (RIG, OBSERVER, CONTROLLER):
        report[node] = newcomer(settled(node))

    report["reset"] = newcomer(lambda ros: ros.trigger(f"{OBSERVER}/reset"))[0]

    def listens(kind, topic):
        def ask(ros):
            heard = []
            keep = ros.node.create_subscription(kind, topic, heard.append, 100)
            return bool(ros.until(lambda: len(heard) > 50, 10) and keep)

        return ask

    report["voltages"] = newcomer(listens(MotorVoltage, "/motor_voltage"))
    report["estimates"] = newcomer(listens(FrictionEstimate, "/friction_estimate"))
    return report


def main() -> None:
    folder, program = sys.argv[1:]
    with caller(fast=True) as ros, Bench(ros, folder) as bench:
        bench.velocity = 1.0
        report = {"orders": orders(bench), "nodes": nodes(bench)}
    report["runner"] = runner(program)
    print(json.dumps(report))


if __name__ == "__main__":
    main()
