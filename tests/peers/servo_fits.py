"""The servo's model as a user of Numba would write it: one compiled loop over one log, step by step.

Reads servo.json from the folder given: the logs on their even grid, the drive, and for every level of friction a population of candidates. Times the mean position error
of the whole population in processor time and prints one line of JSON a level: what, milliseconds (one a round), evaluations, and the sum of the errors.
"""

import json
import math
import sys
import time

import numpy as np
from numba import njit

STEP = 0.005


@njit(cache=False, fastmath=False)
def total(goal, position, enabled, head, full_scale, p, stribeck, ripple):
    """Sum of |simulated - measured| over one log."""
    gain, damping, inertia, moment, supply, q, w = head
    k_t, r, armature, q_offset, k_c, k_v, k_e, k_m, k_cs, k_es, k_ms, k_eq, k_mq, w_s, alpha, delay, k_2, r_sin, r_cos, ripples = p
    inertia = inertia + armature
    per_r = k_t / r
    shift = delay / STEP
    whole = math.floor(shift)
    fraction = shift - whole
    behind = int(whole)
    last = position.size - 1
    error = 0.0
    for k in range(position.size):
        error += abs(q - position[k])
        late = goal[min(max(k - behind, 0), last)]
        early = goal[min(max(k - behind - 1, 0), last)]
        asked = late + (early - late) * fraction
        command = min(max((asked - q) * gain - damping * w, -full_scale), full_scale)
        motor = per_r * (supply * command - k_t * w) if enabled[k] else 0.0
        external = -moment * math.sin(q + q_offset)
        stop = inertia * w / STEP + motor + external
        speed = abs(w)
        level = k_c + abs(k_e * external - k_m * motor) + k_2 * motor * motor
        if stribeck:
            fall = math.exp(-((speed / w_s) ** alpha))
            part = k_cs + abs(k_es * external - k_ms * motor)
            if external * motor < 0.0:
                if abs(motor) > abs(external):
                    part += k_eq * external * external
                else:
                    part += k_mq * motor * motor
            level += fall * part
        if ripple:
            level *= max(1.0 + r_sin * math.sin(q * ripples) + r_cos * math.cos(q * ripples), 0.0)
        level += k_v * speed
        friction = -min(max(stop, -level), level)
        acceleration = (motor + external + friction) / inertia
        w = min(max(w + acceleration * STEP, -100.0), 100.0)
        q = q + w * STEP + acceleration * 0.5 * STEP * STEP
    return error


def main():
    folder, rounds = sys.argv[1], int(sys.argv[2])
    with open(f"{folder}/servo.json") as file:
        data = json.load(file)
    logs = [
        (np.array(log["goal"]), np.array(log["position"]), np.array(log["enabled"]), tuple(float(value) for value in log["head"]))
        for log in data["logs"]
    ]
    samples = sum(position.size for _, position, _, _ in logs)
    for level in data["levels"]:
        candidates = [tuple(float(value) for value in candidate) for candidate in level["candidates"]]
        stribeck, ripple = level["stribeck"], level["ripple"]

        def population():
            return [
                sum(total(*log, data["full_scale"], candidate, stribeck, ripple) for log in logs) / samples for candidate in candidates
            ]

        errors = population()  # compiles
        times = []
        for _ in range(rounds):
            begin = time.process_time()
            errors = population()
            times.append(1e3 * (time.process_time() - begin))
        print(
            json.dumps(
                {"what": level["name"], "milliseconds": times, "evaluations": len(candidates), "mse": sum(errors) / len(errors), "parameters": {}}
            ),
            flush=True,
        )


if __name__ == "__main__":
    main()
