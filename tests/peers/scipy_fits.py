"""The identification fits as a user of SciPy would write them: least_squares over a model compiled by Numba.

Reads lag.csv and joint.csv (columns t_s, velocity_rad_s, torque_Nm) and start.json from the folder given, times each fit and prints one line of JSON a fit:
what, milliseconds (best of the rounds), evaluations, mean square, parameters. The models, the data and the starts are those of the Rust side.
"""

import json
import math
import sys
import time

import numpy as np
from numba import njit
from scipy.optimize import least_squares

DT = 1e-3


@njit(cache=False, fastmath=False)
def lag(v, p, out):
    """Proposed model sliding one way: gamma' = (g - gamma) / tau, F = gamma + f_v v (exponential step, g from the mean of its ends)."""
    f_s, f_c, v_s, f_v, tau = p
    keep = math.exp(-DT / tau)
    g = f_c + (f_s - f_c) * math.exp(-((v[0] / v_s) ** 2))
    gamma = g
    for k in range(v.size):
        if k > 0:
            new = f_c + (f_s - f_c) * math.exp(-((v[k] / v_s) ** 2))
            middle = 0.5 * (g + new)
            gamma = middle + (gamma - middle) * keep
            g = new
        out[k] = gamma + f_v * v[k]


@njit(cache=False, fastmath=False)
def peek(z, st, pz, pf, z_b, f_s):
    """Force of the hysteresis with non-local memory at z; the memory stays."""
    z = min(max(z, -z_b), z_b)
    depth = int(st[2])
    if z == st[0]:
        return st[1]
    s = 1.0 if z > st[0] else -1.0
    oz, of, closes = st[4], st[5], st[6]
    virgin = st[7] > 0.0
    if st[3] != s:
        # A turn: the branch starts at the last point and closes where the one before it started.
        oz, of = st[0], st[1]
        closes = pz[depth - 1] if depth > 0 else -st[0]
        virgin = st[3] == 0.0
    while not virgin and s * (z - closes) >= 0.0:
        # Closed: the branch and the one that it closes are forgotten.
        if st[3] != s and oz == st[0] and of == st[1]:
            depth = depth - 1
        else:
            depth = depth - 2
        if depth <= 0:
            virgin = True
        else:
            oz, of = pz[depth - 1], pf[depth - 1]
            closes = pz[depth - 2] if depth > 1 else -pz[0]
    if virgin:
        return f_s * math.sin(0.5 * math.pi * z / z_b)
    return of + 2.0 * s * f_s * math.sin(0.25 * math.pi * s * (z - oz) / z_b)


@njit(cache=False, fastmath=False)
def commit(z, st, pz, pf, z_b, f_s):
    """Moves to z: remembers reversals, forgets closed loops."""
    z = min(max(z, -z_b), z_b)
    if z == st[0]:
        return st[1]
    depth = int(st[2])
    s = 1.0 if z > st[0] else -1.0
    turning = st[3] == -s
    oz, of, closes = st[4], st[5], st[6]
    virgin = st[7] > 0.0
    if st[3] == 0.0:
        virgin = True
    elif turning:
        oz, of = st[0], st[1]
        closes = pz[depth - 1] if depth > 0 else -st[0]
        virgin = False
        if s * (z - closes) < 0.0 and depth < pz.size:
            pz[depth] = oz
            pf[depth] = of
            depth += 1
        else:
            depth = max(depth - 1, 0)
            virgin = depth == 0
            if not virgin:
                oz, of = pz[depth - 1], pf[depth - 1]
                closes = pz[depth - 2] if depth > 1 else -pz[0]
    while not virgin and s * (z - closes) >= 0.0:
        depth = max(depth - 2, 0)
        virgin = depth == 0
        if not virgin:
            oz, of = pz[depth - 1], pf[depth - 1]
            closes = pz[depth - 2] if depth > 1 else -pz[0]
    if virgin:
        f = f_s * math.sin(0.5 * math.pi * z / z_b)
    else:
        f = of + 2.0 * s * f_s * math.sin(0.25 * math.pi * s * (z - oz) / z_b)
    st[0], st[1], st[2], st[3], st[4], st[5], st[6], st[7] = z, f, depth, s, oz, of, closes, 1.0 if virgin else 0.0
    return f


@njit(cache=False, fastmath=False)
def clip(x, b):
    return min(max(x, -b), b)


@njit(cache=False, fastmath=False)
def rates(gamma, z, v, p, st, pz, pf):
    f_s, f_c, v_s, sigma, tau, z_b, f_v = p
    g = f_c + (f_s - f_c) * math.exp(-((v / v_s) ** 2))
    h = peek(z, st, pz, pf, z_b, f_s)
    contact = clip(h + sigma * v, gamma)
    return contact + f_v * v, (g - gamma) / tau, (contact - h) / sigma


@njit(cache=False, fastmath=False)
def joint_rk4(v, p, out):
    """Proposed model along a velocity with reversals by Runge and Kutta's method of fourth order."""
    f_s, f_c, v_s, sigma, tau, z_b, f_v = p
    st = np.zeros(8)
    pz, pf = np.zeros(120), np.zeros(120)
    st[7] = 1.0
    gamma, z = f_s, 0.0
    h = DT
    for k in range(v.size):
        force, a1, b1 = rates(gamma, z, v[k], p, st, pz, pf)
        out[k] = force
        if k + 1 == v.size:
            break
        middle = 0.5 * (v[k] + v[k + 1])
        _, a2, b2 = rates(gamma + 0.5 * h * a1, z + 0.5 * h * b1, middle, p, st, pz, pf)
        _, a3, b3 = rates(gamma + 0.5 * h * a2, z + 0.5 * h * b2, middle, p, st, pz, pf)
        _, a4, b4 = rates(gamma + h * a3, z + h * b3, v[k + 1], p, st, pz, pf)
        gamma = min(max(gamma + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4), f_c), f_s)
        z = clip(z + h / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4), z_b)
        commit(z, st, pz, pf, z_b, f_s)


@njit(cache=False, fastmath=False)
def joint_fixed(v, p, out):
    """The same with the fixed step of the Rust side: the cheapest that a user could write."""
    f_s, f_c, v_s, sigma, tau, z_b, f_v = p
    st = np.zeros(8)
    pz, pf = np.zeros(120), np.zeros(120)
    st[7] = 1.0
    gamma, z = f_s, 0.0
    keep = math.exp(-DT / tau)
    gain = 1.0 / (sigma + 0.5 * math.pi * f_s / z_b * DT)
    for k in range(v.size):
        out[k] = clip(st[1] + sigma * v[k], gamma) + f_v * v[k]
        if k + 1 == v.size:
            break
        u = 0.5 * (v[k] + v[k + 1])
        g = f_c + (f_s - f_c) * math.exp(-((u / v_s) ** 2))
        slip = min(max(u, (-gamma - st[1]) * gain), (gamma - st[1]) * gain)
        commit(st[0] + DT * slip, st, pz, pf, z_b, f_s)
        gamma = g + (gamma - g) * keep


def fit(model, v, torque, start):
    start = np.array(start)
    out = np.empty_like(torque)

    def residuals(p):
        # Levels in order, everything above zero: as lsqcurvefit would be told by bounds.
        model(v, p, out)
        return out - torque

    calls = 0

    def counted(p):
        nonlocal calls
        calls += 1
        return residuals(p).copy()

    found = least_squares(
        counted, start, bounds=(1e-9, np.inf), x_scale=np.abs(start), method="trf", ftol=1e-8, xtol=1e-8, gtol=1e-12
    )
    return found, calls


def main():
    folder, rounds = sys.argv[1], int(sys.argv[2])
    with open(f"{folder}/start.json") as file:
        starts = json.load(file)
    for what, file, model, keys in [
        ("lag", "lag", lag, ["f_s", "f_c", "v_s", "f_v", "tau"]),
        ("joint, RK4", "joint", joint_rk4, ["f_s", "f_c", "v_s", "sigma", "tau", "z_b", "f_v"]),
        ("joint, fixed step", "joint", joint_fixed, ["f_s", "f_c", "v_s", "sigma", "tau", "z_b", "f_v"]),
    ]:
        table = np.loadtxt(f"{folder}/{file}.csv", delimiter=",", skiprows=1)
        v, torque = np.ascontiguousarray(table[:, 1]), np.ascontiguousarray(table[:, 2])
        start = [starts[file][key] for key in keys]
        fit(model, v, torque, start)  # compiles
        times = []
        for _ in range(rounds):
            begin = time.perf_counter()
            found, calls = fit(model, v, torque, start)
            times.append(1e3 * (time.perf_counter() - begin))
        print(
            json.dumps(
                {
                    "what": what,
                    "milliseconds": times,
                    "evaluations": calls,
                    "mse": 2.0 * found.cost / torque.size,
                    "parameters": dict(zip(keys, found.x.tolist())),
                }
            ),
            flush=True,
        )


if __name__ == "__main__":
    main()
