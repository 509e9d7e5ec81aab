"""Reads a bag with `rosbags` and with `mcap-ros2-support`, knowing no message types but those in the bag itself.

usage: read_bag.py BAG_FOLDER

Prints what was found as JSON.
"""

import json
import sys
from pathlib import Path

from mcap_ros2.reader import read_ros2_messages
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader


def stamp(message) -> int:
    header = message.header.stamp
    return header.sec * 1_000_000_000 + header.nanosec if hasattr(header, "nanosec") else 0


def main() -> None:
    folder = Path(sys.argv[1])
    report = {"topics": {}, "mcap_ros2": {}}
    with Reader(folder) as reader:
        report["message_count"] = reader.message_count
        report["duration"] = reader.duration
        report["start_time"] = reader.start_time
        report["ros_distro"] = reader.ros_distro
        for connection in reader.connections:
            profile = connection.ext.offered_qos_profiles[0]
            report["topics"][connection.topic] = {
                "type": connection.msgtype,
                "digest": connection.digest,
                "count": connection.msgcount,
                "depth": profile.depth,
                "reliability": profile.reliability.name,
                "durability": profile.durability.name,
                "messages": [],
            }
    # No type store is given: the types come out of the bag.
    with AnyReader([folder]) as reader:
        for connection, log_time, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            entry = {"log_time": log_time, "stamp": stamp(message)}
            for name in ("voltage", "name", "position", "effort", "model", "regime", "torque", "stage"):
                value = getattr(message, name, None)
                if value is not None:
                    entry[name] = value.tolist() if hasattr(value, "tolist") else value
            report["topics"][connection.topic]["messages"].append(entry)
    [file] = folder.glob("*.mcap")
    for message in read_ros2_messages(file):
        topic = message.channel.topic
        report["mcap_ros2"][topic] = report["mcap_ros2"].get(topic, 0) + 1
    print(json.dumps(report))


if __name__ == "__main__":
    main()
