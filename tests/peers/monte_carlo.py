"""The Monte Carlo of position tracking as a user of Numba would write it: one compiled loop over cycles, one thread.

Arguments: how many draws, and a seed. Prints one line of JSON: draws, seconds (without compilation), the mean squares of the linear controller alone and of the compensated one in each draw. Plant, sensors, controller,
observer, steps and errors are those of the Rust side; the random numbers are NumPy's own. Only the tachometer's noise is drawn, since nothing else is used.
"""

import json
import math
import sys
import time

import numpy as np
from numba import njit

from scipy_fits import clip, commit, peek

H = 1e-3
CYCLES = 20_000
BACK_EMF = 70.0 * 0.00767
RESISTANCE = 2.6
INERTIA = 0.02388 * BACK_EMF**2 / RESISTANCE
ENCODER = 2.0 * math.pi / 4096.0
CONVERTER = 20.0 / 4096.0
K_P, K_I, K_D, FILTER, LIMIT = 5.7517, 10.0, 0.0768, 0.005, 6.0
# F_s, F_c, v_s, delta, sigma, tau, z_b, f_v of the proposed model on the test bed.
FRICTION = np.array([0.0994, 0.0925, 0.1407, 2.0, 0.3213, 0.0011, 0.006, 0.0403])


@njit(cache=False, fastmath=False)
def level(v, p):
    x = abs(v / p[2])
    shape = x * x if p[3] == 2.0 else x ** p[3]
    return p[1] + (p[0] - p[1]) * math.exp(-shape)


@njit(cache=False, fastmath=False)
def rates(w, gamma, z, volts, p, st, pz, pf):
    """Acceleration and the rates of gamma and z."""
    hysteresis = peek(z, st, pz, pf, p[6], p[0])
    contact = clip(hysteresis + p[4] * w, gamma)
    force = contact + p[7] * w
    applied = BACK_EMF / RESISTANCE * (volts - BACK_EMF * w)
    return (applied - force) / INERTIA, (level(w, p) - gamma) / p[5], (contact - hysteresis) / p[4]


@njit(cache=False, fastmath=False)
def track(p, q, volts_per_newton_metre, seed):
    """Mean square of the position error of a plant with the friction p, compensated with q; not at all if volts_per_newton_metre is zero."""
    np.random.seed(seed)
    st, pz, pf = np.zeros(8), np.zeros(120), np.zeros(120)
    observer, oz, of = np.zeros(8), np.zeros(120), np.zeros(120)
    st[7] = observer[7] = 1.0
    x, w, gamma, z = 0.0, 0.0, p[0], 0.0
    observed = q[0]
    keep = math.exp(-H / q[5])
    implicit = 1.0 / (q[4] + 0.5 * math.pi * q[0] / q[6] * H)
    decay = (2.0 * FILTER - H) / (2.0 * FILTER + H)
    gain = 2.0 / (2.0 * FILTER + H)
    integral, derivative, error_before, seen_before = 0.0, 0.0, 0.0, 0.0
    total, first, last = 0.0, 0.0, 0.0
    h = 0.5 * H
    for k in range(CYCLES + 1):
        reference = math.sin(0.546 * k * H)
        square = (reference - x) ** 2
        if k == 0:
            first = square
        total += square
        last = square
        seen = math.floor(x / ENCODER) * ENCODER
        friction = 0.0
        if volts_per_newton_metre > 0.0:
            noisy = min(max(w + 0.01 * np.random.normal(), -10.0), 10.0)
            v = np.round(noisy / CONVERTER) * CONVERTER
            friction = clip(observer[1] + q[4] * v, observed) + q[7] * v
            g = level(v, q)
            slip = min(max(v, (-observed - observer[1]) * implicit), (observed - observer[1]) * implicit)
            commit(observer[0] + H * slip, observer, oz, of, q[6], q[0])
            observed = g + (observed - g) * keep
        error = reference - seen
        if k == 0:
            error_before, seen_before = error, seen
        new_integral = integral + 0.5 * H * (error + error_before)
        derivative = decay * derivative - gain * (seen - seen_before)
        asked = K_P * error + K_I * new_integral + K_D * derivative + volts_per_newton_metre * friction
        volts = min(max(asked, -LIMIT), LIMIT)
        if volts == asked or asked * error <= 0.0:
            integral = new_integral
        error_before, seen_before = error, seen
        volts = np.round(volts / CONVERTER) * CONVERTER
        for _ in range(2):
            a1, b1, c1 = rates(w, gamma, z, volts, p, st, pz, pf)
            w2 = w + 0.5 * h * a1
            a2, b2, c2 = rates(w2, gamma + 0.5 * h * b1, z + 0.5 * h * c1, volts, p, st, pz, pf)
            w3 = w + 0.5 * h * a2
            a3, b3, c3 = rates(w3, gamma + 0.5 * h * b2, z + 0.5 * h * c2, volts, p, st, pz, pf)
            w4 = w + h * a3
            a4, b4, c4 = rates(w4, gamma + h * b3, z + h * c3, volts, p, st, pz, pf)
            x += h / 6.0 * (w + 2.0 * (w2 + w3) + w4)
            w += h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
            gamma = min(max(gamma + h / 6.0 * (b1 + 2.0 * (b2 + b3) + b4), p[1]), p[0])
            z = clip(z + h / 6.0 * (c1 + 2.0 * (c2 + c3) + c4), p[6])
            commit(z, st, pz, pf, p[6], p[0])
    return (total - 0.5 * (first + last)) / CYCLES


def main():
    draws, seed = int(sys.argv[1]), int(sys.argv[2])
    random = np.random.default_rng(seed)
    exact = RESISTANCE / BACK_EMF
    track(FRICTION, FRICTION, exact, 0)  # compiles
    alone, compensated = [], []
    begin = time.perf_counter()
    for draw in range(draws):
        believed = FRICTION * random.uniform(0.8, 1.2, FRICTION.size)
        if believed[0] < believed[1]:
            believed[0], believed[1] = believed[1], believed[0]
        volts = exact * random.uniform(0.8, 1.2)
        alone.append(track(FRICTION, believed, 0.0, draw))
        compensated.append(track(FRICTION, believed, volts, draw))
    seconds = time.perf_counter() - begin
    print(json.dumps({"draws": draws, "seconds": seconds, "alone": alone, "compensated": compensated}))


if __name__ == "__main__":
    main()
