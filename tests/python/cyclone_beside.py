"""Asks the same services with rclpy, over and over, while somebody else asks over Cyclone DDS; says when it
begins, ends when its input is closed, and prints JSON."""

import json
import sys
import threading

from lifecycle_msgs.srv import GetState
from ros_calls import caller
from std_srvs.srv import Trigger

with caller() as ros:
    ended = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
    report = {"lists": [], "states": [], "stops": 0, "hashes": {}}
    names = ["/joint_states", "/rosout", "/parameter_events", "/rig_driver/transition_event"]
    while not ended.is_set():
        report["lists"].append(len(ros.list("/friction_observer").names))
        report["states"].append(ros.call(GetState, "/friction_observer/get_state", GetState.Request()).current_state.label)
        if len(report["lists"]) == 1:
            print("asking", flush=True)
        report["stops"] += bool(ros.call(Trigger, "/rig_driver/emergency_stop", Trigger.Request()).message)
    for name in names:
        report["hashes"][name] = [str(end.topic_type_hash) for end in ros.node.get_publishers_info_by_topic(name)]
    report["enclaves"] = sorted({e for n, _, e in ros.node.get_node_names_and_namespaces_with_enclaves() if n == "friction_observer"})
    print(json.dumps(report))
