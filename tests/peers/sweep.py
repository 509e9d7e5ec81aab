"""Many parameter sets of a friction model along one motion as a user of Numba would write it: one compiled loop over time, `prange` over the sets.

Arguments: the file of sets that `sweep_speed --sets` wrote, samples, threads. Prints one line of JSON a model and way: nanoseconds a step (processor time for `one`, wall time of all
threads for `prange`) and the sum of all forces. Scheme (each velocity held), motion and parameters are those of the Rust side; the results go into an array that is there already.
"""

import json
import math
import sys
import time

import numpy as np
from numba import njit, prange, set_num_threads

DT = 1e-3


@njit(inline="always")
def level(v, f_s, f_c, v_s, delta):
    r = v / v_s
    power = r * r if delta == 2.0 else abs(r) ** delta
    return f_c + (f_s - f_c) * math.exp(-power)


@njit(parallel=True, cache=False, fastmath=False)
def lugre(p, velocity, out):
    for i in prange(p.shape[0]):
        f_s, f_c, v_s, delta, sigma0, sigma1, f_v = p[i]
        z = 0.0
        for k in range(velocity.size):
            v = velocity[k]
            g = level(v, f_s, f_c, v_s, delta)
            rate = sigma0 * abs(v) / g
            steady = math.copysign(g / sigma0, v)
            out[i, k] = sigma0 * z + sigma1 * (v - rate * z) + f_v * v
            z = steady + (z - steady) * math.exp(-rate * DT)


@njit(parallel=True, cache=False, fastmath=False)
def gms(p, velocity, out):
    for i in prange(p.shape[0]):
        f_s, f_c, v_s, delta, f_v = p[i, :5]
        n = (p.shape[1] - 5) // 4
        alpha, sigma0, sigma1, c = p[i, 5 : 5 + n], p[i, 5 + n : 5 + 2 * n], p[i, 5 + 2 * n : 5 + 3 * n], p[i, 5 + 3 * n :]
        z = np.zeros(n)
        slips = np.zeros(n)
        for k in range(velocity.size):
            v = velocity[k]
            g = level(v, f_s, f_c, v_s, delta)
            direction = float(np.sign(v))
            force = f_v * v
            for e in range(n):
                width = alpha[e] / sigma0[e] * g
                if slips[e] * direction > 0.0:
                    relaxation = c[e] / width
                    rest = direction * width
                    force += sigma0[e] * z[e] + sigma1[e] * (c[e] * direction - relaxation * z[e])
                    z[e] = rest + (z[e] - rest) * math.exp(-relaxation * DT)
                else:
                    force += sigma0[e] * z[e] + sigma1[e] * v
                    z[e] += v * DT
                    if direction != 0.0 and direction * z[e] >= width:
                        slips[e] = direction
                        z[e] = direction * width
                    else:
                        slips[e] = 0.0
            out[i, k] = force


@njit(parallel=True, cache=False, fastmath=False)
def xiong(p, velocity, out):
    for i in prange(p.shape[0]):
        f_s, f_c, v_s, delta, tau, f_v = p[i, :6]
        n = (p.shape[1] - 6) // 3
        share, stiffness, sigma = p[i, 6 : 6 + n], p[i, 6 + n : 6 + 2 * n], p[i, 6 + 2 * n :]
        decay = math.exp(-DT / tau)
        gain = 1.0 / (sigma + stiffness * DT)
        gamma = f_s
        z = np.zeros(n)
        for k in range(velocity.size):
            v = velocity[k]
            g = level(v, f_s, f_c, v_s, delta)
            force = f_v * v
            for e in range(n):
                most = share[e] * gamma
                elastic = stiffness[e] * z[e]
                force += max(-most, min(most, elastic + sigma[e] * v))
                z[e] += DT * max((-most - elastic) * gain[e], min((most - elastic) * gain[e], v))
            gamma = g + (gamma - g) * decay
            out[i, k] = force


@njit(parallel=True, cache=False, fastmath=False)
def proposed(p, velocity, out):
    for i in prange(p.shape[0]):
        f_s, f_c, v_s, delta, sigma, tau, z_b, f_v = p[i]
        decay = math.exp(-DT / tau)
        wave = math.pi / (2.0 * z_b)
        gain = 1.0 / (sigma + f_s * wave * DT)
        gamma = f_s
        z, f = 0.0, 0.0
        # The present branch, and the reversals behind it.
        s, z_r, f_r, closes, double = 0.0, 0.0, 0.0, 0.0, 1.0
        zs, fs = np.empty(122), np.empty(122)
        depth = 0
        for k in range(velocity.size):
            v = velocity[k]
            g = level(v, f_s, f_c, v_s, delta)
            out[i, k] = max(-gamma, min(gamma, f + sigma * v)) + f_v * v
            to = z + DT * max((-gamma - f) * gain, min((gamma - f) * gain, v))
            to = max(-z_b, min(z_b, to))
            if to != z:
                if not (s * (to - z) > 0.0 and s * (to - closes) < 0.0):
                    turned = 1.0 if to > z else -1.0
                    if s == -turned:
                        if depth == 120:
                            depth -= 2
                        zs[depth], fs[depth] = z, f
                        depth += 1
                    s = turned
                    # Branches that have closed are forgotten with those that they closed.
                    while True:
                        if depth == 0:
                            z_r, f_r, closes, double = 0.0, 0.0, s * np.inf, 1.0
                            break
                        z_r, f_r, double = zs[depth - 1], fs[depth - 1], 2.0
                        closes = zs[depth - 2] if depth > 1 else -z_r
                        if s * (to - closes) < 0.0:
                            break
                        depth = max(depth - 2, 0)
                z = to
                f = f_r + double * s * f_s * math.sin(wave * s * (z - z_r) / double)
            gamma = g + (gamma - g) * decay


COLUMNS = {
    "lugre": ["f_s", "f_c", "v_s", "delta", "sigma0", "sigma1", "f_v"],
    "gms": ["f_s", "f_c", "v_s", "delta", "f_v", "alpha", "sigma0", "sigma1", "c"],
    "xiong": ["f_s", "f_c", "v_s", "delta", "tau", "f_v", "lambda", "k", "sigma"],
    "proposed": ["f_s", "f_c", "v_s", "delta", "sigma", "tau", "z_b", "f_v"],
}
MODELS = {"lugre": lugre, "gms": gms, "xiong": xiong, "proposed": proposed}


def main():
    with open(sys.argv[1]) as file:
        lines = [json.loads(line) for line in file]
    samples, threads = int(sys.argv[2]), int(sys.argv[3])
    t = DT * np.arange(samples)
    velocity = 0.02 + 0.2 * np.sin(3.0 * t) + 0.05 * np.sin(41.0 * t)
    for line in lines:
        name = line["model"]
        sets = [np.concatenate([np.atleast_1d(one[name][key]) for key in COLUMNS[name]]) for one in line["sets"]]
        sets = np.array(sets, dtype=float)
        out = np.zeros((len(sets), samples))
        MODELS[name](sets, velocity[:10], out)
        for way, count, clock in [("one", 1, time.process_time), ("prange", threads, time.perf_counter)]:
            set_num_threads(count)
            started = clock()
            MODELS[name](sets, velocity, out)
            nanoseconds = 1e9 * (clock() - started) / out.size
            print(json.dumps({"model": name, "scheme": "held", "way": way, "nanoseconds": nanoseconds, "sum": float(out.sum())}))


main()
