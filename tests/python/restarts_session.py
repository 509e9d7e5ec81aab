"""Each side of the loop ends, is killed and comes back while the others go on. usage: restarts_session.py FOLDER"""

import json
import signal
import sys
import time

from rig_bench import CONTROLLER, PROGRAMS, RIG, Bench
from ros_calls import caller

HOW = {"SIGINT": signal.SIGINT, "SIGKILL": signal.SIGKILL}


def without_controller(bench, how):
    """The motor from the moment the controller goes until it is told to go on."""
    bench.forget()
    ros = bench.ros
    ros.spin(0.3)
    code, _, _ = bench.end("controller", how)
    bench.hear(0.8)
    last, voltage, fault = bench.last_command(), bench.last_voltage(), bench.first_fault(bench.last_command())
    told = {"code": code, "last_voltage": voltage - last, "fault": fault - last}
    told["state"] = ros.state(RIG) if ros.until(lambda: ros.state(RIG) == "inactive", 3) else ros.state(RIG)
    bench.start("controller")
    bench.commands.clear()
    told["commands_again"] = ros.until(lambda: len(bench.commands) > 50, 60)
    back = time.time()
    bench.hear(0.4)
    told["voltage_in_fault"] = bench.highest(back)
    told["cleared"] = bench.clear_and_activate()
    told["moves_again"] = bench.moves(1.0)
    return told


def without_observer(bench, how):
    """The loop goes on without compensation, and with it when the observer is back."""
    ros = bench.ros
    bench.end("friction_observer", how)
    ros.spin(0.5)
    bench.forget()
    bench.hear(0.4)
    told = {
        "friction": max((abs(s.friction) for s in bench.states[-100:]), default=None),
        "moves": bench.moves(1.0),
        "faults": sum(m.fault for m in bench.measured),
    }
    bench.start("friction_observer")
    told["compensates_again"] = ros.until(lambda: bench.states and abs(bench.states[-1].friction) > 0.05, 10)
    return told


def without_rig(bench, how):
    """A simulated rig starts by itself."""
    code, _, _ = bench.end("rig_driver", how)
    bench.forget()
    bench.ros.spin(0.3)
    bench.forget()
    bench.start("rig_driver")
    return {"code": code, "moves_again": bench.moves(1.0)}


def main() -> None:
    with caller(fast=True) as ros, Bench(ros, sys.argv[1]) as bench:
        bench.velocity = 1.0
        # The rig comes last.
        bench.start(*reversed(PROGRAMS))
        report = {"moves": bench.moves(1.0, 30)}
        for name, how in HOW.items():
            report[name] = {
                "controller": without_controller(bench, how),
                "friction_observer": without_observer(bench, how),
                "rig_driver": without_rig(bench, how),
            }
        # A rig that does not start by itself stands until it is activated, whatever is asked of it.
        bench.end("rig_driver", signal.SIGKILL)
        bench.start("rig_driver", arguments=("-p", "autostart:=false"))
        report["waits"] = [ros.state(RIG), ros.change(RIG, "configure")]
        bench.forget()
        begin = time.time()
        report["heard_waiting"] = bench.hear(0.6) is True and len(bench.measured) > 100
        report["voltage_waiting"] = bench.highest(begin)
        report["activated"] = [ros.change(RIG, "activate"), bench.moves(1.0)]
        report["states"] = [ros.state(RIG), ros.state(CONTROLLER)]
        report["exit"] = [list(bench.end(name)[:2]) for name in PROGRAMS]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
