"""Publishers of /friction_estimate at 1 kHz: the laboratory's, and one of rclpy. Prints what each costs and how fast it is, as JSON.

usage: bench_session.py FRICTIONLAB SECONDS MINUTES CLIENTS

SECONDS is the length of each measurement, MINUTES the time after which memory is read, CLIENTS how many join and leave to see what memory each leaves behind.
"""

import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time

import rclpy
from friction_msgs.action import RunExperiment
from friction_msgs.msg import FrictionEstimate, Reference
from launch_session import children
from rcl_interfaces.srv import GetParameters
from rclpy.action import ActionClient, ActionServer
from rclpy.experimental import EventsExecutor
from readers import Child, end_with_parent
from rig_bench import resident_kilobytes
from ros_calls import SIGNAL

TOPIC = "/friction_estimate"
ACTION = "/experiment_runner/run_experiment"
COUNTED = "counted"
PERIOD_NS = 1_000_000
BLOCKS = 5
NEWCOMERS = 5
CALLS = 20
TICKS = os.sysconf("SC_CLK_TCK")


def talk():
    """The publisher of rclpy, as people write one: a timer, a message, and what every node has. Its action ends each goal at once."""
    rclpy.init()
    node = rclpy.create_node("friction_observer")
    publisher = node.create_publisher(FrictionEstimate, TOPIC, 100)
    message = FrictionEstimate(model=COUNTED)

    def publish():
        message.torque += 1.0
        message.header.stamp = node.get_clock().now().to_msg()
        publisher.publish(message)

    def execute(goal):
        goal.abort()
        return RunExperiment.Result()

    keep = [node.create_timer(0.001, publish), ActionServer(node, RunExperiment, ACTION, execute)]
    rclpy.spin(node)
    del keep


class Reader:
    """Hears the topic by callbacks; delays are from the stamp of a message to its callback."""

    def __init__(self, name):
        self.node = rclpy.create_node(name)
        self.executor = EventsExecutor()
        self.executor.add_node(self.node)
        self.node.create_subscription(FrictionEstimate, TOPIC, self.take, SIGNAL)
        self.begin()

    def begin(self):
        self.count, self.began = 0, time.monotonic()
        self.first = self.last = None
        self.delays = []

    def take(self, message):
        stamp = message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec
        # The laboratory's stamps are a period apart; rclpy's timer is not that regular, so that its messages are counted.
        number = message.torque if message.model == COUNTED else stamp / PERIOD_NS
        self.first, self.last = self.first or number, number
        self.count += 1
        self.delays.append(time.time_ns() - stamp)

    def report(self):
        delays = sorted(self.delays) or [0]
        at = lambda share: delays[int(share * (len(delays) - 1))] / 1000
        sent = round(self.last - self.first) + 1 if self.count else 0
        rate = self.count / (time.monotonic() - self.began)
        return {"count": self.count, "rate_hz": rate, "lost": max(0, sent - self.count), "p50_us": at(0.5), "p99_us": at(0.99)}

    def run(self, orders, answers):
        os.set_blocking(orders, False)
        while True:
            end = time.monotonic() + 0.05
            while time.monotonic() < end:
                self.executor.spin_once(timeout_sec=0.01)
            try:
                read = os.read(orders, 4096)
            except BlockingIOError:
                continue
            if not read:
                return
            if b"report" in read:
                os.write(answers, json.dumps(self.report()).encode() + b"\n")
            self.begin()


def reader(name):
    return Child(name, lambda orders, answers: Reader(name).run(orders, answers))


def refer(_orders, _answers):
    """The reference of the launched nodes."""
    node = rclpy.create_node("reference")
    publisher = node.create_publisher(Reference, "/reference", 10)
    while True:
        publisher.publish(Reference(velocity=1.5 if time.monotonic() % 2 < 1 else -1.5))
        time.sleep(0.01)


def newcomer(_orders, answers):
    """Joins, hears, calls, and sends goals; how long each took [s]."""
    began = time.monotonic()
    node = rclpy.create_node(f"newcomer_{os.getpid()}")
    executor = EventsExecutor()
    executor.add_node(node)
    heard = []
    node.create_subscription(FrictionEstimate, TOPIC, heard.append, SIGNAL)

    def until(condition):
        end = time.monotonic() + 30
        while not condition() and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.01)
        return time.monotonic()

    times = {"first_message": until(lambda: heard) - began}
    client = node.create_client(GetParameters, "/friction_observer/get_parameters")
    calls = []
    while len(calls) <= CALLS:
        began = time.monotonic()
        until(client.service_is_ready)
        future = client.call_async(GetParameters.Request(names=["use_sim_time"]))
        calls.append(until(future.done) - began)
    times["first_call"], times["later_call"] = calls[0], statistics.median(calls[1:])
    goals = []
    action = ActionClient(node, RunExperiment, ACTION)
    while len(goals) <= CALLS:
        began = time.monotonic()
        until(action.server_is_ready)
        # Nobody knows such an experiment: the goal ends at once.
        goal = action.send_goal_async(RunExperiment.Goal(experiment="none"))
        until(goal.done)
        if not goal.done():
            break
        until(goal.result().get_result_async().done)
        goals.append(time.monotonic() - began)
    if goals:
        times["first_goal"], times["later_goal"] = goals[0], statistics.median(goals[1:] or goals)
    os.write(answers, json.dumps(times).encode() + b"\n")
    executor.remove_node(node)
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown()


def visitor(_orders, _answers):
    """Joins, hears once, and leaves."""
    node = rclpy.create_node(f"visitor_{os.getpid()}")
    heard = []
    node.create_subscription(FrictionEstimate, TOPIC, heard.append, SIGNAL)
    end = time.monotonic() + 10
    while not heard and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)
    node.destroy_node()
    rclpy.shutdown()


def wait(child):
    text = b""
    while not text.endswith(b"\n"):
        read = os.read(child.answers, 1 << 16)
        if not read:
            break
        text += read
    os.waitpid(child.pid, 0)
    return json.loads(text) if text else {}


def processor_s(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def hear(readers, pids, seconds):
    """Medians over blocks, so that what else the machine does for a moment does not count; losses are those of all."""
    blocks = [block(readers, pids, seconds / BLOCKS) for _ in range(BLOCKS)]
    median = lambda key: statistics.median(one[key] for one in blocks)
    cost = lambda name: statistics.median(one["processor_percent"][name] for one in blocks)
    return {
        "rate_hz": median("rate_hz"),
        "lost": statistics.mean(one["lost"] for one in blocks),
        "p50_us": median("p50_us"),
        "p99_us": median("p99_us"),
        "processor_percent": {name: cost(name) for name in pids},
    }


def block(readers, pids, seconds):
    """What the readers heard together, and what the publisher's processes cost meanwhile."""
    for child in readers:
        child.order("begin")
    before, began = {name: processor_s(pid) for name, pid in pids.items()}, time.monotonic()
    time.sleep(seconds)
    took = time.monotonic() - began
    cost = {name: 100 * (processor_s(pid) - before[name]) / took for name, pid in pids.items()}
    heard = [child.report() for child in readers]
    mean = lambda key: statistics.mean(one[key] for one in heard)
    return {
        "rate_hz": mean("rate_hz"),
        "lost": mean("lost") / max(1, mean("lost") + mean("count")),
        "p50_us": statistics.median(one["p50_us"] for one in heard),
        "p99_us": statistics.median(one["p99_us"] for one in heard),
        "processor_percent": cost,
    }


def measure(name, command, lengths, out):
    """Everything of one publisher; `command` is what is started, none for the one of rclpy."""
    seconds, minutes, clients = lengths
    readers = [reader("reader_0")]
    others, began = [], time.monotonic()
    if command is None:
        running = os.fork()
        if running == 0:
            try:
                talk()
            finally:
                os._exit(1)
        pids = {"rclpy": running}
    else:
        with open(os.path.join(out, f"{name}.log"), "w", encoding="utf-8") as said:
            process = subprocess.Popen(command, stdout=said, stderr=said, cwd=out, preexec_fn=end_with_parent)
        running, pids = process.pid, {name: process.pid}
        if name == "launch":
            others.append(Child("reference", refer))
    try:
        while (heard := readers[0].report())["count"] < 100 and time.monotonic() - began < 60:
            time.sleep(0.2)
        assert heard["count"] > 0, f"{name}: nothing is heard"
        time.sleep(2)
        if name == "launch":
            pids = children(running)
        report = {"one": hear(readers, pids, seconds)}
        memory = lambda: {process: resident_kilobytes(pid) for process, pid in pids.items()}
        report["memory_kb"] = memory()
        time.sleep(60 * minutes)
        report["memory_late_kb"] = memory()
        told = [wait(Child("newcomer", newcomer)) for _ in range(NEWCOMERS)]
        report["seconds"] = {key: statistics.median(one[key] for one in told if key in one) for key in told[0]}
        report["worst_seconds"] = {key: max(one[key] for one in told if key in one) for key in told[0]}
        before = memory()
        for _ in range(clients):
            wait(Child("visitor", visitor))
        after = memory()
        report["memory_after_kb"] = after
        report["kb_a_client"] = {process: (after[process] - before[process]) / max(1, clients) for process in after}
        readers += [reader(f"reader_{index}") for index in range(1, 10)]
        time.sleep(8)
        report["ten"] = hear(readers, pids, seconds)
        return report
    finally:
        for child in [*readers, *others]:
            child.end()
        os.kill(running, signal.SIGINT if command else signal.SIGKILL)
        os.waitpid(running, 0)


def main() -> None:
    program, seconds, minutes, clients = sys.argv[1:]
    report = {}
    with tempfile.TemporaryDirectory() as out:
        live = [program, "live", "--serve", "--amplitude", "1.5", "--frequency", "3", "--out", os.path.join(out, "run")]
        for name, command in {"rclpy": None, "live": live, "launch": [program, "launch"]}.items():
            report[name] = measure(name, command, (float(seconds), float(minutes), int(clients)), out)
    print(json.dumps(report))


if __name__ == "__main__":
    main()
