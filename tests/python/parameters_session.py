"""What `ros2 param` does, on the observer and the controller. usage: parameters_session.py FOLDER"""

import json
import sys

import rclpy
from processes import Processes
from rcl_interfaces.msg import Log, ParameterEvent
from rclpy.qos import DurabilityPolicy, QoSProfile
from ros_calls import caller

OBSERVER, CONTROLLER = "/friction_observer", "/controller"


def main() -> None:
    with caller() as ros, Processes(sys.argv[1]) as programs:
        events, logs = [], []
        keep = [
            ros.node.create_subscription(ParameterEvent, "/parameter_events", events.append, 1000),
            ros.node.create_subscription(
                Log, "/rosout", logs.append, QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            ),
        ]
        programs.start("friction_observer", "-p", "model:=lugre", "-p", "no_such:=1")
        programs.start("controller", "-p", "lag.k_p:=1.25")
        listed = ros.list(OBSERVER)
        under = ros.list(OBSERVER, ["lugre"])
        report = {
            "names": list(listed.names),
            "prefixes": list(listed.prefixes),
            "lugre": list(under.names),
            "shallow": list(ros.list(OBSERVER, depth=1).names),
            "given": ros.get(OBSERVER, "model") + ros.get(CONTROLLER, "lag.k_p"),
            "unknown": ros.get(OBSERVER, "no_such"),
            "types": ros.types(OBSERVER, "model", "lugre.sigma0", "no_such", "use_sim_time"),
        }
        # describe
        sigma0, model, period, missing = ros.describe(OBSERVER, "lugre.sigma0", "model", "period", "no_such")
        report["described"] = {
            "sigma0": [
                sigma0.type,
                sigma0.description,
                [[r.from_value, r.to_value] for r in sigma0.floating_point_range],
                sigma0.additional_constraints,
            ],
            "model": [model.type, model.description, model.additional_constraints],
            "period_read_only": period.read_only,
            "missing": missing.type,
        }
        # set: good, then each way of being wrong
        old = ros.get(OBSERVER, "lugre.sigma0")[0]
        f_s, f_c = ros.get(OBSERVER, "lugre.f_s", "lugre.f_c")
        events.clear()
        report["good"] = ros.set(OBSERVER, lugre__sigma0=2 * old)
        report["read_back"] = ros.get(OBSERVER, "lugre.sigma0")[0] == 2 * old
        ros.until(lambda: any(c.name == "lugre.sigma0" for e in events for c in e.changed_parameters), 5)
        report["events"] = [[e.node, c.name, c.value.double_value / old] for e in events for c in e.changed_parameters]
        report["refused"] = {
            "type": ros.set(OBSERVER, lugre__sigma0=3)[0],
            "range": ros.set(OBSERVER, lugre__sigma0=-1.0)[0],
            "nan": ros.set(OBSERVER, lugre__sigma0=float("nan"))[0],
            "between": ros.set(OBSERVER, lugre__f_c=2 * f_s)[0],
            "choice": ros.set(OBSERVER, model="lugri")[0],
            "deleted": ros.set(OBSERVER, model=None)[0],
            "undeclared": ros.set(OBSERVER, no_such=1)[0],
            "read_only": ros.set(OBSERVER, period=0.002)[0],
            "controller": ros.set(CONTROLLER, compensation_scale=3.0)[0],
        }
        report["half"] = ros.set(OBSERVER, injection=1.0, model="nonsense")
        report["injection"] = ros.get(OBSERVER, "injection")[0]
        report["atomic_bad"] = ros.set_atomically(OBSERVER, injection=2.0, model="nonsense")
        report["injection_after_bad"] = ros.get(OBSERVER, "injection")[0]
        report["atomic_good"] = ros.set_atomically(OBSERVER, lugre__f_c=2 * f_s, lugre__f_s=3 * f_s)
        report["levels"] = [x / f_s for x in ros.get(OBSERVER, "lugre.f_s", "lugre.f_c")]
        # `ros2 param dump` reads all values, `load` sets them again
        names = [name for name in listed.names if name not in ("period", "autostart", "start_type_description_service")]
        values = ros.get(OBSERVER, *names)
        loaded = [ros.set(OBSERVER, **{name.replace(".", "__"): x})[0] for name, x in zip(names, values) if not isinstance(x, list)]
        report["loaded"] = [len(loaded), [reason for good, reason in loaded if not good]]
        ros.spin(0.5)
        report["rosout"] = sorted({log.name for log in logs if log.name in ("friction_observer", "controller")})
        report["written_at"] = [[log.file, log.line] for log in logs if "no_such" in log.msg]
        report["warned"] = [log.msg for log in logs if "no_such" in log.msg and log.level == 30]
        report["keep"] = len(keep)
        # /clock under use_sim_time
        from builtin_interfaces.msg import Time
        from rosgraph_msgs.msg import Clock

        clock = ros.node.create_publisher(Clock, "/clock", 10)
        report["sim_time_set"] = ros.set(CONTROLLER, use_sim_time=True)[0]
        events.clear()

        def shown():
            clock.publish(Clock(clock=Time(sec=1234, nanosec=5)))
            ros.spin(0.05)
            ros.set(CONTROLLER, fade=0.2)
            return any(e.stamp.sec == 1234 and e.node == CONTROLLER for e in events)

        report["sim_time_seen"] = ros.until(shown, 10)
        programs_out = [programs.end(p) for p in list(programs.running)]
        report["exit"] = [[code, took] for code, took, _ in programs_out]
        print(json.dumps(report))


if __name__ == "__main__":
    main()
