"""Stands in for a rig and an experiment runner, with rclpy: known signals at 200 Hz, and an action that counts to its end.

usage: stand_in.py NAMESPACE

The experiment `steady` goes through ten steps of .1 s, `endless` ends only when it is cancelled, `broken` fails, anything
else is refused.
"""

import contextlib
import math
import sys
import threading
import time

import rclpy
from friction_msgs.action import RunExperiment
from friction_msgs.msg import ControllerState, FrictionEstimate, Reference
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState

QOS = QoSProfile(depth=100)


def publish(node, namespace: str) -> None:
    """The rig: velocity 2 cos 3t, friction 0.09 sgn v + 0.04 v, an estimate that is 0.01 N m low."""
    start = time.monotonic()
    kinds = {"joint_states": JointState, "friction_estimate": FrictionEstimate, "controller_state": ControllerState}
    kinds["reference"] = Reference
    publishers = {name: node.create_publisher(kind, f"{namespace}/{name}", QOS) for name, kind in kinds.items()}

    def cycle() -> None:
        t = time.monotonic() - start
        velocity = 2.0 * math.cos(3.0 * t)
        torque = math.copysign(0.09, velocity) + 0.04 * velocity
        messages = {
            "joint_states": JointState(name=["load_shaft"], position=[0.0], velocity=[velocity], effort=[torque]),
            "friction_estimate": FrictionEstimate(model="lugre", torque=torque - 0.01, velocity=velocity),
            "controller_state": ControllerState(mode=0, reference=velocity + 0.1, feedback=velocity, error=0.1),
            "reference": Reference(velocity=velocity + 0.1),
        }
        now = node.get_clock().now().to_msg()
        for name, message in messages.items():
            message.header.stamp = now
            publishers[name].publish(message)

    node.create_timer(0.005, cycle, callback_group=ReentrantCallbackGroup())


def run(handle):
    """One experiment."""
    asked = handle.request
    result = RunExperiment.Result(run_id="run-1", bag_path="/tmp/run-1/bag")
    if asked.experiment not in ("steady", "endless", "broken"):
        result.outcome = RunExperiment.Result.BAD_REQUEST
        result.message = f"there is no experiment `{asked.experiment}`; expected steady, endless or broken"
        handle.abort()
        return result
    steps = 10 if asked.experiment == "steady" else 10_000
    for step in range(steps):
        if not rclpy.ok():
            return result
        if handle.is_cancel_requested:
            result.outcome = RunExperiment.Result.CANCELED
            result.message = f"cancelled after {step} steps"
            handle.canceled()
            return result
        stage = "first half" if step < 5 else "second half"
        remaining = math.nan if step == 0 else 0.1 * (steps - step)
        handle.publish_feedback(RunExperiment.Feedback(stage=stage, repetition=1, progress=step / steps, remaining=remaining))
        time.sleep(0.1)
        if asked.experiment == "broken" and step == 2:
            result.outcome, result.message = RunExperiment.Result.FAILED, "the rig does not answer"
            handle.abort()
            return result
    result.success = True
    told = {setting.name: setting.value for setting in asked.overrides}
    result.message = f"models {list(asked.models)}, repetitions {asked.repetitions}, overrides {told}"
    figure = type(result).get_fields_and_field_types()["figures"]
    assert figure == "sequence<friction_msgs/Figure>", figure
    from friction_msgs.msg import EstimatedParameter, Figure

    result.figures = [
        Figure(task="velocity tracking", row="lugre", name="mse", unit="(rad/s)^2", value=2.5e-5, deviation=math.nan)
    ]
    result.parameters = [EstimatedParameter(model="lugre", name="f_s", unit="N m", value=0.1, identified=True)]
    handle.succeed()
    return result


def main() -> None:
    namespace = sys.argv[1]
    rclpy.init()
    node = rclpy.create_node("stand_in")
    publish(node, namespace)
    server = ActionServer(
        node,
        RunExperiment,
        f"{namespace}/experiment_runner/run_experiment",
        execute_callback=run,
        cancel_callback=lambda _: CancelResponse.ACCEPT,
        callback_group=ReentrantCallbackGroup(),
    )
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    # Whoever started it closes its standard input to end it.
    threading.Thread(target=lambda: (sys.stdin.read(), rclpy.try_shutdown()), daemon=True).start()
    print("ready", flush=True)
    with contextlib.suppress(ExternalShutdownException, KeyboardInterrupt):
        executor.spin()
    server.destroy()


if __name__ == "__main__":
    main()
