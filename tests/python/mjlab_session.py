"""A friction that was exported, put into an entity by the real mjlab and run in the MuJoCo that it stands on.

Reads the same JSON document as `simulators_session.py`, whose `include` is here the text of a Python
file, and prints the same answer.
"""

import contextlib
import importlib.metadata
import json
import sys

import mujoco
from mjlab.actuator.builtin_actuator import BuiltinMotorActuatorCfg
from mjlab.entity import Entity, EntityArticulationInfoCfg, EntityCfg
from simulators_session import moved


def body(asked):
    """A body that turns about one joint."""
    spec = mujoco.MjSpec()
    part = spec.worldbody.add_body(name="link")
    part.add_joint(name=asked["joint"], type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    part.mass, part.inertia, part.explicitinertial = 1.0, [asked["inertia"]] * 3, True
    part.ipos = [0, 0, 0]
    return spec


def compiled(asked):
    exported = {}
    exec(compile(asked["include"], "exported", "exec"), exported)  # noqa: S102 it is what is tried
    friction = exported[f"{asked['joint'].upper()}_FRICTION"]
    if isinstance(friction, dict):
        # Beside the actuator that drives the joint, which gives nothing here.
        friction = BuiltinMotorActuatorCfg(
            target_names_expr=(asked["joint"],), effort_limit=1.0, **friction
        )
    config = EntityCfg(spec_fn=lambda: body(asked), articulation=EntityArticulationInfoCfg(actuators=(friction,)))
    model = Entity(config).compile()
    model.opt.timestep = asked["dt"]
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.gravity[:] = 0.0
    return model


def main():
    asked = json.load(sys.stdin)
    # What it says while it starts is no part of the answer.
    with contextlib.redirect_stdout(sys.stderr):
        said = moved(compiled(asked), asked, importlib.metadata.version("mjlab"))
    json.dump(said, sys.stdout)


main()
