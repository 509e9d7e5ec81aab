"""Serves /ping (std_srvs/srv/Trigger) over Cyclone DDS until its input is closed; answers with how many asked. Its answers to others than the asker are as clients see them."""

import sys
import threading

from cyclone_ros import *  # noqa: F403

count = itertools.count(1)
ended = threading.Event()
threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
server = Ros(0).server("/ping", "std_srvs/srv/Trigger", None, {"success": bool, "message": str})
print("ready", flush=True)
server.serve(lambda _: (True, f"pong {next(count)}"), ended.is_set)
