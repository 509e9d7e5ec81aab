"""Samples beside a long run of a sampler that others wrote (emcee) over the likelihood that they stand for.

To the Stribeck curve steady points are independent. To other models they count as so many as `effective_samples`
says: the logarithm of the likelihood is multiplied by that share of them. Quantiles agree within 5 % of the width in
which 95 % lie.
"""

import os
from pathlib import Path

import frictionlab
import numpy as np
import pytest

NAMES = ["f_s", "f_c", "v_s", "f_v"]
SHARES = [0.025, 0.16, 0.5, 0.84, 0.975]


def curve(p, v):
    f_s, f_c, v_s, f_v = p
    return np.sign(v) * (f_c + (f_s - f_c) * np.exp(-((v / v_s) ** 2))) + f_v * v


# Steady points each way and their noise [N m]: a fit that is sure of everything, and one that is not.
@pytest.mark.parametrize(("each", "noise"), [(60, 0.001), (12, 0.004)])
def test_the_quantiles_are_those_of_a_long_markov_chain(each, noise):
    emcee = pytest.importorskip("emcee")
    random = np.random.default_rng(5)
    v = np.r_[-np.geomspace(0.01, 3.0, each), np.geomspace(0.01, 3.0, each)]
    torque = curve([0.15, 0.1, 0.2, 0.04], v) + noise * random.standard_normal(v.size)
    found = frictionlab.identify({"velocity_rad_s": v, "torque_Nm": torque}, model="stribeck")
    best = np.array([found["stribeck"][name].value for name in NAMES])
    errors = np.array([found["stribeck"][name].standard_error for name in NAMES])
    sigma = np.sqrt(np.sum((torque - curve(best, v)) ** 2) / (v.size - len(best)))

    def log_density(p):
        if (p <= 0.0).any() or p[1] > p[0]:
            return -np.inf
        return -0.5 * np.sum(((torque - curve(p, v)) / sigma) ** 2)

    start = best + 0.1 * errors * random.standard_normal((32, len(best)))
    sampler = emcee.EnsembleSampler(32, len(best), log_density)
    sampler.random_state = np.random.RandomState(1).get_state()
    sampler.run_mcmc(start, 6000)
    chain = sampler.get_chain(discard=1000, flat=True)
    drawn = found.samples(100_000, seed=2)
    for at, name in enumerate(NAMES):
        theirs, ours = np.quantile(chain[:, at], SHARES), np.quantile(drawn[name], SHARES)
        # Within 5 % of the width in which 95 % lie.
        assert np.max(np.abs(ours - theirs)) < 0.05 * (theirs[-1] - theirs[0]), (name, ours, theirs)


def filtered(values, rate, cutoff):
    signal = pytest.importorskip("scipy.signal")
    return signal.filtfilt(*signal.butter(4, 2.0 * cutoff / rate), values)


def points(position, force, rate, cutoff, slowest, block):
    """Steady points of a recording: what is left of the force without inertia and offset, in means over blocks."""
    v = np.gradient(filtered(position, rate, cutoff), 1.0 / rate)
    columns = np.c_[np.gradient(v, 1.0 / rate), v, np.sign(v), np.ones_like(v)]
    force = filtered(force, rate, cutoff)
    moves = np.abs(v) > slowest
    inertia, _, _, offset = np.linalg.lstsq(columns[moves], force[moves], rcond=None)[0]
    friction = (force - inertia * columns[:, 0] - offset)[100:-100]
    count = len(friction) // block
    friction = friction[: count * block].reshape(count, block).mean(axis=1)
    speed = v[100:-100][: count * block].reshape(count, block).mean(axis=1)
    moves = np.abs(speed) > slowest
    return speed[moves], friction[moves]


def emps(data):
    rows = np.genfromtxt(data / "emps/estimation.csv", delimiter=",", skip_header=1)
    return points(rows[:, 2], 35.150651882485472 * rows[:, 3], 1000.0, 100.0, 0.001, 50)


def tx40(data):
    """The first joint, which carries no weight, on its own side of the gear."""
    position, torque = (
        np.genfromtxt(data / f"tx40/motor_{name}.csv", delimiter=",", skip_header=1, usecols=0)
        for name in ("position_rad", "torque_Nm")
    )
    return points(position / 32.0, 32.0 * torque, 5000.0, 50.0, 0.02, 125)


@pytest.mark.parametrize("recorded", [emps, tx40])
def test_the_quantiles_hold_on_real_recordings(recorded):
    emcee = pytest.importorskip("emcee")
    data = Path(os.environ.get("FRICTION_DATA", "../shared/data"))
    if not data.is_dir():
        pytest.skip("FRICTION_DATA names no folder with real recordings")
    v, force = recorded(data)
    found = frictionlab.identify({"velocity_rad_s": v, "torque_Nm": force}, model="coulomb_viscous")
    told = found.document["models"]["coulomb_viscous"]["information"]
    counted = told["effective_samples"]
    assert told["samples"] == len(v)
    # These residuals are far from independent: the model is not the axis.
    assert counted < 0.4 * len(v)

    def log_density(p):
        """Of friction and of the logarithm of the deviation, about which nothing is known before."""
        residuals = force - p[:, :1] * np.sign(v) - p[:, 1:2] * v
        likelihood = -len(v) * p[:, 2] - 0.5 * np.sum(residuals**2, axis=1) * np.exp(-2.0 * p[:, 2])
        return np.where((p[:, :2] > 0.0).all(axis=1), counted / len(v) * likelihood, -np.inf)

    fit = found["coulomb_viscous"]
    best = np.array([fit["f_c"].value, fit["f_v"].value, np.log(fit.error)])
    errors = np.array([fit["f_c"].standard_error, fit["f_v"].standard_error, 0.1])
    start = best + 0.1 * errors * np.random.default_rng(3).standard_normal((32, 3))
    sampler = emcee.EnsembleSampler(32, 3, log_density, vectorize=True)
    sampler.random_state = np.random.RandomState(1).get_state()
    sampler.run_mcmc(start, 6000)
    chain = sampler.get_chain(discard=1000, flat=True)
    drawn = found.samples(100_000, seed=2)
    for at, name in enumerate(("f_c", "f_v")):
        theirs, ours = np.quantile(chain[:, at], SHARES), np.quantile(drawn[name], SHARES)
        off = np.max(np.abs(ours - theirs)) / (theirs[-1] - theirs[0])
        print(recorded.__name__, name, f"{100 * off:.2f} % of the width", len(v), "points count as", round(counted))
        assert off < 0.05, (name, ours, theirs)
    theirs, ours = np.corrcoef(chain[:, :2].T)[0, 1], drawn[["f_c", "f_v"]].corr().iloc[0, 1]
    assert abs(ours - theirs) < 0.05, (ours, theirs)
