"""LuGre along a motion as a user of Numba would write it: one compiled loop, the results in arrays, no text.

Argument: the number of points. Prints one line of JSON: points and seconds (without compilation). Scheme, motion and parameters are those of the Rust side.
"""

import json
import math
import sys
import time

import numpy as np
from numba import njit

H = 1e-3
F_S, F_C, V_S, SIGMA0, SIGMA1, F_V = 0.0994, 0.0929, 0.1407, 16.469, 0.2494, 0.0403


@njit(cache=False, fastmath=False)
def simulate(count, force, deflection, level):
    z = 0.0
    v = 0.0
    for k in range(count):
        v = 0.3 * math.sin(5.0 * k * H)
        g = F_C + (F_S - F_C) * math.exp(-((v / V_S) ** 2))
        force[k] = SIGMA0 * z + SIGMA1 * (v - SIGMA0 * abs(v) / g * z) + F_V * v
        deflection[k] = z
        level[k] = g
        mean = 0.5 * (v + 0.3 * math.sin(5.0 * (k + 1) * H))
        g = F_C + (F_S - F_C) * math.exp(-((mean / V_S) ** 2))
        rate = SIGMA0 * abs(mean) / g
        end = math.copysign(g / SIGMA0, mean)
        z = end + (z - end) * math.exp(-rate * H)


def main():
    count = int(sys.argv[1])
    arrays = [np.empty(count) for _ in range(3)]
    simulate(10, *arrays)
    started = time.perf_counter()
    simulate(count, *arrays)
    print(json.dumps({"points": count, "seconds": time.perf_counter() - started}))


main()
