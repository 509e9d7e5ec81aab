"""A friction that was exported, run in the real MuJoCo along a torque.

Reads from standard input a JSON document:

    include     the exported file's text
    class       class of the joint, or null
    joint       name of the joint
    inertia     of the body [kg m^2]
    dt          step [s]
    torque      the torque at each step [N m]
    every       steps between two rows of the answer

and prints version, position and velocity at every so many steps.
"""

import json
import sys
import tempfile
from pathlib import Path

import mujoco


def model(asked, folder):
    """A body that turns about one joint, with the exported file included."""
    (folder / "friction.xml").write_text(asked["include"])
    klass = f'class="{asked["class"]}"' if asked["class"] else ""
    j = asked["inertia"]
    host = f"""<mujoco>
      <option timestep="{asked['dt']!r}" integrator="implicitfast" gravity="0 0 0"/>
      <include file="friction.xml"/>
      <worldbody><body>
        <joint name="{asked['joint']}" type="hinge" axis="0 0 1" {klass}/>
        <inertial pos="0 0 0" mass="1" diaginertia="{j} {j} {j}"/>
      </body></worldbody>
    </mujoco>"""
    (folder / "host.xml").write_text(host)
    return mujoco.MjModel.from_xml_path(str(folder / "host.xml"))


def moved(compiled, asked, version):
    """The answer: the motion of a compiled model along the torque."""
    data = mujoco.MjData(compiled)
    position, velocity = [], []
    for k, torque in enumerate(asked["torque"]):
        if k % asked["every"] == 0:
            position.append(data.qpos[0])
            velocity.append(data.qvel[0])
        data.qfrc_applied[0] = torque
        mujoco.mj_step(compiled, data)
    return {"version": version, "inputs": compiled.nu, "position": position, "velocity": velocity}


def main():
    asked = json.load(sys.stdin)
    with tempfile.TemporaryDirectory() as folder:
        compiled = model(asked, Path(folder))
    json.dump(moved(compiled, asked, mujoco.__version__), sys.stdout)


if __name__ == "__main__":
    main()
