"""Readers that are frozen, killed, slow or gone from the network, beside one that keeps up. Prints what that one heard, alone and beside them.

usage: frozen_session.py FOLDER FRICTIONLAB WAY SECONDS READER...

WAY is launch, live or processes. READER is stopped, killed, slow, best_effort or gone, as often as there are such; `gone` needs another machine, $OTHER_MACHINE.
"""

import faulthandler
import faulthandler
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from readers import SIGNALS, end_with_parent, healthy_reader, sick_reader
from rig_bench import PROGRAMS

ALONE_S = 3.0
# How long Fast DDS lets others take it for alive when it is silent.
LEASE_S = 20.0
# How long it may take until everybody is there.
PATIENCE_S = 60.0
# What takes longer than this beside the measurement hangs: then it says where.
HANGS_S = 240.0


def programs(folder, program, way, out):
    """What is started, each with how it is ended."""
    if way == "processes":
        return [[os.path.join(folder, name)] for name in PROGRAMS]
    if way == "launch":
        return [[program, "launch"]]
    return [[program, "live", "--amplitude", "1.5", "--frequency", "3", "--out", os.path.join(out, "run")]]


def until_all_are_heard(healthy):
    """Waits until every signal comes, and everybody has settled."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        time.sleep(0.5)
        heard = healthy.report()
        if all(heard["topics"][topic]["count"] > 200 for topic in SIGNALS):
            return
    raise RuntimeError(f"the loop does not close: {heard}")


def until_said(said, words, seconds):
    """Waits for a line of the programs with all these words."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        said.flush()
        with open(said.name, encoding="utf-8") as file:
            if any(all(word in line for word in words) for line in file):
                return True
        time.sleep(0.2)
    return False


def until_it_hears(child, seconds):
    """Waits until a reader that was held up hears of the loop again."""
    before, end = child.heard(), time.monotonic() + seconds
    while time.monotonic() < end:
        if child.heard() > before + 1000:
            return True
        time.sleep(0.2)
    return False


def link(state):
    """Takes the other machine's cable out, or puts it in."""
    other = os.environ["OTHER_MACHINE"]
    subprocess.run(["nsenter", "-t", other, "-n", "ip", "link", "set", "wire", state], check=True)


def main() -> None:
    folder, program, way, seconds, *kinds = sys.argv[1:]
    seconds = float(seconds)
    faulthandler.dump_traceback_later(HANGS_S + seconds, exit=True)
    other = os.environ.get("OTHER_MACHINE")
    report, running, sick = {"way": way, "readers": kinds}, [], []
    healthy = healthy_reader("healthy", refers=way != "live")
    try:
        with tempfile.TemporaryDirectory() as out, open(os.path.join(out, "said"), "w+", encoding="utf-8") as said:
            for command in programs(folder, program, way, out):
                running.append(subprocess.Popen(command, stdout=said, stderr=said, preexec_fn=end_with_parent))
            until_all_are_heard(healthy)
            healthy.order("begin")
            time.sleep(ALONE_S)
            report["alone"] = healthy.report()
            for index, kind in enumerate(kinds):
                sick.append(sick_reader(f"{kind}_{index}", kind, network=other if kind == "gone" else None))
            # They begin, and hear for a while.
            time.sleep(1.5 + 0.8 * len(kinds))
            report["joining"] = healthy.report()
            for child in sick:
                if child.kind in ("stopped", "killed"):
                    child.send(signal.SIGSTOP if child.kind == "stopped" else signal.SIGKILL)
            if "gone" in kinds:
                link("down")
            healthy.order("begin")
            time.sleep(seconds)
            report["beside"] = healthy.report()
            # Those that were only held up come back.
            for child in sick:
                if child.kind == "stopped":
                    child.send(signal.SIGCONT)
            if "gone" in kinds:
                link("up")
            back = [child for child in sick if child.kind in ("stopped", "gone")]
            report["hears"] = {child.name: until_it_hears(child, 60) for child in back}
            # Whoever was away for longer than its lease was given up, and comes as a new reader.
            back = [child.name for child in back if child.kind == "stopped" and seconds < LEASE_S]
            report["back"] = {name: until_said(said, [f"/{name} ", "keeps up again"], 30) for name in back}
            report["after"] = healthy.report()
            report["early"] = [process.poll() for process in running]
            for process in running:
                process.send_signal(signal.SIGINT)
            report["codes"] = [process.wait(timeout=30) for process in running]
            said.seek(0)
            report["said"] = said.read()
    finally:
        for child in [healthy, *sick]:
            child.end()
        for process in running:
            if process.poll() is None:
                process.kill()
    print(json.dumps(report))


if __name__ == "__main__":
    main()
