"""Samples beside a long run of a sampler that others wrote (emcee) over the same likelihood."""

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
