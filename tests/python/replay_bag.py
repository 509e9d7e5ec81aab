"""Publishes the messages of a bag with rclpy, as `ros2 bag play` does, and compares what a subscriber gets.

usage: replay_bag.py BAG_FOLDER [MESSAGES]

Of each topic at most MESSAGES are played, as the bytes that stand in the bag; the subscriber takes the bytes that arrive, and the messages they
are. Prints as JSON: for each topic how many were played, how many arrived with the same content.
"""

import importlib
import json
import os
import sys
import threading
import time
from pathlib import Path

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message
from rosbags.rosbag2 import Reader


def kind(name: str):
    package, folder, name = name.split("/")
    return getattr(importlib.import_module(f"{package}.{folder}"), name)


def main() -> None:
    folder = Path(sys.argv[1])
    most = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    played: dict[str, list[bytes]] = {}
    types = {}
    durable = {}
    with Reader(folder) as reader:
        for connection in reader.connections:
            types[connection.topic] = kind(connection.msgtype)
            durable[connection.topic] = connection.ext.offered_qos_profiles[0].durability.name == "TRANSIENT_LOCAL"
        for connection, _, data in reader.messages():
            messages = played.setdefault(connection.topic, [])
            if len(messages) < most:
                messages.append(bytes(data))

    rclpy.init()
    node = rclpy.create_node("player")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    arrived = {topic: [] for topic in played}
    publishers = {}
    for topic in played:
        durability = DurabilityPolicy.TRANSIENT_LOCAL if durable[topic] else DurabilityPolicy.VOLATILE
        profile = QoSProfile(depth=2 * most, durability=durability)
        node.create_subscription(types[topic], topic, arrived[topic].append, profile, raw=True)
        publishers[topic] = node.create_publisher(types[topic], topic, profile)
    end = time.monotonic() + 20.0
    while any(publisher.get_subscription_count() == 0 for publisher in publishers.values()):
        assert time.monotonic() < end, "the subscriptions are not found"
        time.sleep(0.02)
    for topic, messages in played.items():
        for message in messages:
            publishers[topic].publish(message)
            time.sleep(0.0005)
    while any(len(arrived[topic]) < len(messages) for topic, messages in played.items()):
        if time.monotonic() > end + 20.0:
            break
        time.sleep(0.02)

    def same(topic: str) -> int:
        pairs = zip(played[topic], arrived[topic])
        # Representations: not-a-number is equal to itself then.
        read = lambda data: repr(deserialize_message(data, types[topic]))  # noqa: E731
        return sum(read(sent) == read(bytes(got)) for sent, got in pairs)

    print(json.dumps({topic: {"played": len(played[topic]), "same": same(topic)} for topic in played}))
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
