"""A friction that was exported, run in the real Newton on the processor along a torque.

Reads the same JSON document as `simulators_session.py`, whose `include` is here the text of a Python
file, and prints the same answer.
"""

import contextlib
import json
import sys

import newton
import numpy as np
import warp as wp


def built(asked):
    """A body that turns about one joint with the exported friction."""
    exported = {}
    exec(compile(asked["include"], "exported", "exec"), exported)  # noqa: S102 it is what is tried
    joint = asked["joint"]
    of_joint = exported.get(f"{joint.upper()}_DOF", {})
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
    body = builder.add_link(mass=1.0, inertia=wp.mat33(np.diag([asked["inertia"]] * 3)))
    axis = newton.ModelBuilder.JointDofConfig(axis=(0.0, 0.0, 1.0), **of_joint)
    index = builder.add_joint_revolute(parent=-1, child=body, axis=axis, label=joint)
    builder.add_articulation([index])
    if f"add_{joint}_friction" in exported:
        exported[f"add_{joint}_friction"](builder, index)
    return builder.finalize(device="cpu")


def run(asked):
    model = built(asked)
    solver = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True)
    now, then, control = model.state(), model.state(), model.control()
    position, velocity = [], []
    for k, torque in enumerate(asked["torque"]):
        if k % asked["every"] == 0:
            position.append(float(now.joint_q.numpy()[0]))
            velocity.append(float(now.joint_qd.numpy()[0]))
        control.joint_f.fill_(torque)
        solver.step(now, then, control, None, asked["dt"])
        now, then = then, now
    inputs = solver.mj_model.nu
    return {"version": newton.__version__, "inputs": inputs, "position": position, "velocity": velocity}


def main():
    wp.config.quiet = True
    asked = json.load(sys.stdin)
    # What it says while it compiles is no part of the answer.
    with contextlib.redirect_stdout(sys.stderr):
        said = run(asked)
    json.dump(said, sys.stdout)


main()
