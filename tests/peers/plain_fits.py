"""What an engineer with SciPy would do in an afternoon: the same recording, the usual filter, three models, scored on the part kept back.

Reads jobs as a JSON list from standard input: folder, cutoff_hz, acceleration_cutoff_hz, order, trim, decimate, low_pass_force, stretches, elsewhere (the same filter settings for the validation part). In each folder are `estimation.csv` and `validation.csv` with the columns time, q, (dq), tau. Prints a JSON list: for each
job the relative error of the torque in the validation part, in per cent, of least squares (inertia, viscous and Coulomb friction, offset), of Dahl's model and of LuGre's beside the same inertia and offset; with `gravity` in the job, of the same with a sin q + b cos q besides. Only the stretches of that part count that are named [s]: at rest, what a model says is no prediction.
"""

import json
import sys

import numpy as np
from numba import njit
from scipy.optimize import least_squares
from scipy.signal import butter, decimate, filtfilt


def read(path):
    with open(path) as file:
        names = file.readline().strip().split(",")
        table = np.loadtxt(file, delimiter=",")
    return {name: table[:, index] for index, name in enumerate(names)}


def condition(table, job, h):
    t = table["time"]
    even = np.arange(t[0], t[-1], h)
    q, tau = np.interp(even, t, table["q"]), np.interp(even, t, table["tau"])

    def smooth(x, cutoff):
        nyquist = 0.5 / h
        return filtfilt(*butter(job["order"], cutoff / nyquist), x) if cutoff < nyquist else x

    q = smooth(q, job["cutoff_hz"])
    if job.get("low_pass_force"):
        tau = smooth(tau, job["cutoff_hz"])
    v = np.gradient(q, h)
    slow = job["acceleration_cutoff_hz"]
    a = np.gradient(smooth(v, slow) if slow < job["cutoff_hz"] else v, h)
    cut = slice(job["trim"], len(q) - job["trim"])
    return v[cut], a[cut], tau[cut], [np.sin(q[cut]), np.cos(q[cut])]


def thin(x, factor):
    return decimate(x, factor, zero_phase=True) if factor > 1 else x


@njit(error_model="numpy")
def dahl(v, h, f_c, sigma0):
    out = np.empty_like(v)
    f = 0.0
    for k in range(v.size):
        rate = sigma0 / f_c * abs(v[k])
        keep = np.exp(-rate * h)
        f = np.sign(v[k]) * f_c * (1.0 - keep) + f * keep
        out[k] = f
    return out


@njit(error_model="numpy")
def lugre(v, h, f_c, f_s, v_s, sigma0, sigma1):
    out = np.empty_like(v)
    z = 0.0
    for k in range(v.size):
        g = f_c + (f_s - f_c) * np.exp(-((v[k] / v_s) ** 2))
        rate = sigma0 / g * abs(v[k])
        keep = np.exp(-rate * h)
        end = np.sign(v[k]) * g / sigma0
        new = end + (z - end) * keep
        out[k] = sigma0 * new + sigma1 * (new - z) / h
        z = new
    return out


def inside(times, stretches, step):
    """Whether each row lies in one of the stretches that count; all do where none are named."""
    if stretches is None:
        return np.full(times.size, True)
    return np.any([(times > first - 0.5 * step) & (times < last + 0.5 * step) for first, last in stretches], axis=0)


def linear(columns, tau):
    matrix = np.column_stack(columns)
    return np.linalg.lstsq(matrix, tau, rcond=None)[0]


def score(tau, predicted, moves):
    return 100.0 * np.linalg.norm((tau - predicted)[moves]) / np.linalg.norm(tau[moves])


def plain(job):
    tables = [read(f"{job['folder']}/{name}.csv") for name in ("estimation", "validation")]
    h = float(np.median(np.diff(tables[0]["time"])))
    hows = job, job | (job.get("elsewhere") or {})
    parts = [condition(table, how, h) for table, how in zip(tables, hows)]
    errors = fits(hows, h, parts, False)
    if job.get("gravity"):
        errors |= {f"{name} with gravity": error for name, error in fits(hows, h, parts, True).items()}
    return {name: float(error) for name, error in errors.items() if np.isfinite(error)}


def fits(hows, h, parts, gravity):
    (factor, factor2), there = [how["decimate"] for how in hows], hows[1]
    (v, a, tau, weight), (v2, a2, tau2, weight2) = parts
    y, y2 = thin(tau, factor), thin(tau2, factor2)
    step = factor2 * h
    moves = inside(there["trim"] * h + step * np.arange(y2.size), there["stretches"], step)

    def others(v, a, weight, factor):
        columns = [a, v, np.ones_like(v)] + (weight if gravity else [])
        return np.column_stack([thin(column, factor) for column in columns])

    fixed, fixed2 = others(v, a, weight, factor), others(v2, a2, weight2, factor2)
    errors = {}
    theta = linear([fixed, thin(np.sign(v), factor)], y)
    errors["least squares"] = score(y2, np.column_stack([fixed2, thin(np.sign(v2), factor2)]) @ theta, moves)
    f_c = max(abs(theta[-1]), 1e-9)
    travel = np.ptp(np.cumsum(v) * h)
    speed = np.sqrt(np.mean(v**2))

    def fit(force, start):
        def residuals(logarithms):
            rest = y - thin(force(v, np.exp(logarithms)), factor)
            return rest - fixed @ linear([fixed], rest)

        try:
            found = least_squares(residuals, np.log(start), method="trf", max_nfev=30, x_scale="jac")
        except (ValueError, np.linalg.LinAlgError):
            return np.inf  # it left the finite numbers
        p = np.exp(found.x)
        theta = linear([fixed], y - thin(force(v, p), factor))
        error = score(y2, fixed2 @ theta + thin(force(v2, p), factor2), moves)
        return error if np.isfinite(error) else np.inf

    errors["Dahl"] = fit(lambda v, p: dahl(v, h, p[0], p[1]), [f_c, 100.0 * f_c / travel])
    start = [f_c, 1.2 * f_c, 0.05 * speed, 100.0 * f_c / travel, f_c / speed]
    errors["LuGre"] = fit(lambda v, p: lugre(v, h, *p), start)
    return errors


def main():
    json.dump([plain(job) for job in json.load(sys.stdin)], sys.stdout)


main()
