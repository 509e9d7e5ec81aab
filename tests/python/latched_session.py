"""What a late joiner of a latched topic is sent, after few and many messages. Prints it as JSON.

usage: latched_session.py COMMAND...

The command reads numbers and publishes until it has published so many, on /experiment_status, which keeps one, and on /last_three, which keeps three; each message is its
number.
"""

import json
import subprocess
import sys
import time

import rclpy
from friction_msgs.msg import ExperimentStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

TOPICS = ("/experiment_status", "/last_three")
BEHIND_S = 0.5


class Joiner:
    """Somebody who joins now, with a participant of his own."""

    def __init__(self, depth):
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.node = rclpy.create_node("joiner", context=self.context)
        self.executor.add_node(self.node)
        self.heard = {topic: [] for topic in TOPICS}
        latched = QoSProfile(depth=depth, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        for topic in TOPICS:
            take = lambda message, topic=topic: self.heard[topic].append(int(message.message))
            self.node.create_subscription(ExperimentStatus, topic, take, latched)

    def spin(self, seconds, until=lambda: False):
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until():
            self.executor.spin_once(timeout_sec=0.02)

    def hears(self, last):
        """Everything until the last, and what comes after it although nothing should."""
        self.spin(20, lambda: all(last in heard for heard in self.heard.values()))
        self.spin(BEHIND_S)
        return self.heard

    def leave(self):
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)


def main() -> None:
    publisher = subprocess.Popen(sys.argv[1:], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    present = Joiner(10)
    report = {}
    try:
        for count in (1, 5, 100):
            publisher.stdin.write(f"{count}\n")
            publisher.stdin.flush()
            # Somebody who is there hears the last one, so that it is published.
            present.hears(count)
            report[count] = {}
            for depth in (1, 10):
                joiner = Joiner(depth)
                report[count][depth] = joiner.hears(count)
                joiner.leave()
        report["present"] = present.heard
        publisher.stdin.close()
        report["code"] = publisher.wait(timeout=20)
    finally:
        publisher.kill()
        present.leave()
    print(json.dumps(report))


if __name__ == "__main__":
    main()
