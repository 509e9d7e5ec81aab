"""Axes that MuJoCo simulates: they stick, slip and follow a position loop as real joints do.

Reads {"numbers": [...], "folder": ...} from standard input. For each number it draws an axis, lets
a position loop move it, and writes both halves of the recording into a folder of that number. It
answers what is true of each axis, in its first half where it changes.

Friction is MuJoCo's own (frictionloss and damping): a constraint that the solver holds, not one of
the models that are fitted.
"""

import csv
import json
import math
import pathlib
import sys

import mujoco
import numpy as np

STEP = 2e-4
RATES = [100, 125, 250, 500, 1000]
MOTIONS = ["tones", "tones", "triangle", "moves", "chirp"]
BESIDE = [None, None, None, None, "warms up", "ripple", "coarse torque", "direction", "bristle"]

AXIS = """
<mujoco>
  <option timestep="{step}" integrator="implicitfast"/>
  <worldbody>
    <body euler="{tilt} 0 0">
      <joint name="axis" type="hinge" axis="0 0 1" armature="{armature}" frictionloss="{f_c}"
             damping="{f_v}" solreffriction="0.002 1" solimpfriction="0.99 0.999 0.001 0.5 2"/>
      <inertial pos="{arm} 0 0" mass="{mass}" diaginertia="{inner} {inner} {inner}"/>
    </body>
  </worldbody>
  <actuator><motor joint="axis"/></actuator>
</mujoco>
"""


class Motion:
    """A reference with its rate, from rest."""

    def __init__(self, rng, length):
        self.kind = MOTIONS[rng.integers(len(MOTIONS))]
        self.length = length
        count = int(rng.integers(2, 6))
        self.w = 2 * math.pi * rng.uniform(0.05, 10 ** rng.uniform(-0.5, 0.3), count)
        self.size = rng.uniform(0.1, 0.8) * rng.uniform(0.3, 1, count) / math.sqrt(count)
        self.phase = rng.uniform(0, 2 * math.pi, count)
        self.rate, self.travel = rng.uniform(0.05, 0.4), rng.uniform(0.2, 1.2)
        self.goals = rng.uniform(-1, 1, 200) * rng.uniform(0.3, 1.2)
        self.goals[0] = 0.0
        self.move, self.rest = rng.uniform(0.5, 2.0), rng.uniform(0, 0.7)

    def at(self, t):
        begun = min(1.0, t / 2)
        if self.kind == "tones":
            place = np.sum(self.size * (np.sin(self.w * t + self.phase) - np.sin(self.phase)))
            return begun * place, begun * np.sum(
                self.size * self.w * np.cos(self.w * t + self.phase)
            )
        if self.kind == "triangle":
            part = (t * self.rate) % 1
            place = 4 * part if part < 0.25 else 2 - 4 * part if part < 0.75 else 4 * part - 4
            way = -1 if 0.25 <= part < 0.75 else 1
            return self.travel * place, way * 4 * self.travel * self.rate
        if self.kind == "chirp":
            grows = 3 * self.rate / (2 * self.length)
            w = 2 * math.pi * (0.05 + 2 * grows * t)
            angle = 2 * math.pi * (0.05 * t + grows * t * t)
            size = begun * self.travel
            return size * math.sin(angle), size * w * math.cos(angle)
        number = int(t / (self.move + self.rest))
        part = min(1.0, (t - number * (self.move + self.rest)) / self.move)
        start, end = self.goals[number % 200], self.goals[(number + 1) % 200]
        place = part**3 * (10 - 15 * part + 6 * part**2)
        rate = 30 * part**2 * (1 - part) ** 2 / self.move
        return start + (end - start) * place, (end - start) * rate


def axis(number, folder):
    rng = np.random.default_rng(number)
    mass, arm = 10 ** rng.uniform(-0.5, 1), rng.uniform(0.05, 0.5)
    tilt = rng.choice([0, 1, 1]) * rng.uniform(0.2, math.pi / 2)
    f_c, f_v = 10 ** rng.uniform(-0.3, 0.8), 10 ** rng.uniform(-0.8, 0.8)
    text = AXIS.format(
        step=STEP, tilt=math.degrees(tilt), armature=10 ** rng.uniform(-2, 0.3), f_c=f_c, f_v=f_v,
        arm=arm, mass=mass, inner=0.05 * mass * arm**2,
    )  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    full = np.zeros((1, 1))
    mujoco.mj_fullM(model, data, full)
    inertia = float(full[0, 0])
    rate, length = int(rng.choice(RATES)), rng.uniform(30, 80)
    motion, beside = Motion(rng, length), BESIDE[rng.integers(len(BESIDE))]
    band = 2 * math.pi * rng.uniform(2, 8)
    stiffness, damping = inertia * band**2, 2 * rng.uniform(0.6, 1.2) * inertia * band
    integral = rng.choice([0, 1]) * stiffness * rng.uniform(0.5, 3)
    encoder = 2 * math.pi / 2 ** int(rng.integers(12, 20))
    noise, late = rng.uniform(0.003, 0.05) * f_c, bool(rng.random() < 1 / 3)
    data.qpos[0] = start = rng.uniform(-2, 2)
    rows, total, bristle, every = [], 0.0, 0.0, round(1 / (rate * STEP))
    for step in range(int(length / STEP)):
        t = step * STEP
        place, velocity = motion.at(t)
        q, v = data.qpos[0], data.qvel[0]
        total += integral * (start + place - q) * STEP
        torque = stiffness * (start + place - q) + damping * (velocity - v) + total
        data.ctrl[0] = torque
        if beside == "warms up":
            model.dof_frictionloss[0] = f_c * (1.1 - 0.2 * t / length)
            model.dof_damping[0] = f_v * (1.2 - 0.4 * t / length)
        elif beside == "ripple":
            data.qfrc_applied[0] = 0.15 * f_c * math.sin(17 * q)
        elif beside == "direction":
            model.dof_frictionloss[0] = f_c * (1.15 if v > 0 else 0.85)
        elif beside == "bristle":
            bristle += (v - abs(v) * bristle / 0.02) * STEP
            data.qfrc_applied[0] = -0.3 * f_c * bristle / 0.02
        if step % every == 0:
            shown = torque + noise * rng.standard_normal()
            if beside == "coarse torque":
                shown = round(shown / (0.15 * f_c)) * 0.15 * f_c
            rows.append([t, round(q / encoder) * encoder, shown])
        mujoco.mj_step(model, data)
    if late:
        rows = [[t, q, torque] for (t, q, _), (_, _, torque) in zip(rows[1:], rows)]
    folder.mkdir(parents=True, exist_ok=True)
    half = len(rows) // 2
    for name, part in [("estimation", rows[:half]), ("validation", rows[half:])]:
        with open(folder / f"{name}.csv", "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["time", "q", "tau"])
            writer.writerows([[f"{value:.9g}" for value in row] for row in part])
    # At a quarter of the recording, the middle of its first half.
    f_c *= {"warms up": 1.05, "bristle": 1.3}.get(beside, 1.0)
    f_v *= {"warms up": 1.1}.get(beside, 1.0)
    # Friction of two levels is one level and a constant force. A weight that turns a little is one
    # too, for whoever sees no more of it.
    offset = 0.15 * f_c if beside == "direction" else None if tilt else 0.0
    has = [motion.kind, *([beside] if beside else []), *(["a sample late"] if late else [])]
    if tilt:
        has.append("gravity")
    return {
        "number": number,
        "has": has,
        "true": {"inertia": inertia, "f_c": f_c, "f_v": f_v, "offset": offset, "rate": rate},
    }


def main():
    asked = json.load(sys.stdin)
    root = pathlib.Path(asked["folder"])
    told = []
    for number in asked["numbers"]:
        print(f"machine {number} moves ...", file=sys.stderr)
        told.append(axis(number, root / str(number)))
    json.dump(told, sys.stdout)


if __name__ == "__main__":
    main()
