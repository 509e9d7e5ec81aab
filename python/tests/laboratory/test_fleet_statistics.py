"""Statements about chance, counted on fleets whose truth is known."""

import os

import numpy as np
import pytest

pytest.importorskip("scipy")

from frictionlab.fleet import changes, pooled
from frictionlab.fleet.trial.drift import judged
from frictionlab.fleet.trial.made import MadeFleet

# The long tier counts over more.
TIMES = 4 if os.environ.get("FRICTION_FULL") else 1


@pytest.mark.parametrize("influence", [0.0, -0.02])
def test_false_alarms_come_at_the_stated_rate(influence):
    random, count, length = np.random.default_rng(3), 500 * TIMES, 25
    alarms = 0
    for _ in range(count):
        errors = 0.01 * np.exp(0.5 * random.standard_normal(length))
        warm = random.normal(25.0, 5.0, length)
        values = 1.0 + influence * warm + np.hypot(errors, 0.01) * random.standard_normal(length)
        alarms += changes(values, errors, warm, false_alarms=0.1).changed
    # Within three standard deviations of such a count.
    assert abs(alarms - 0.1 * count) < 3.0 * np.sqrt(0.09 * count)


def test_degrading_joints_are_found_soon_and_others_left_alone():
    found = judged(MadeFleet(joints=500 if TIMES > 1 else 200, growth=0.02))
    assert found.degrading >= 10 and found.found == found.degrading
    assert found.delay <= 8.0
    assert found.false_alarms <= 0.01 * found.steady + 3.0 * np.sqrt(0.01 * found.steady)


def test_an_influence_of_the_temperature_is_no_change():
    random, n = np.random.default_rng(2), 40
    warm = 20.0 + np.arange(n) * 0.5 + random.standard_normal(n)
    values = 1.0 - 0.01 * warm + 0.01 * random.standard_normal(n)
    assert changes(values).changed and not changes(values, conditions=warm).changed
    assert changes([1.0, 2.0]) is None
    assert not changes(np.ones(30)).changed and changes(np.r_[np.ones(15), 2.0 * np.ones(15)]).changed


@pytest.mark.parametrize(("machines", "runs"), [(2, 6), (3, 4), (6, 5), (20, 3), (5, 1), (1, 8)])
def test_intervals_of_pooled_estimates_hold_the_truth(machines, runs):
    random, count = np.random.default_rng(4), 300 * TIMES
    held = predicted = 0
    for _ in range(count):
        names = np.repeat(np.arange(machines), runs)
        errors = 0.01 * np.exp(0.4 * random.standard_normal(names.size))
        values = 0.02 * random.standard_normal(machines)[names] * (machines > 1)
        values += np.hypot(errors, 0.01) * random.standard_normal(names.size)
        found = pooled(1.0 + values, errors, names)
        held += found.interval_95[0] <= 1.0 <= found.interval_95[1]
        other = 1.0 + (0.02 if machines > 1 else 0.01) * random.standard_normal()
        predicted += found.prediction_95[0] <= other <= found.prediction_95[1]
    assert held / count > 0.95 - 3.0 * np.sqrt(0.0475 / count)
    assert predicted / count > (0.9 if machines > 1 else 0.8)


def test_variances_within_and_between_are_told_apart():
    random = np.random.default_rng(5)
    names = np.repeat(np.arange(200), 6)
    values = 0.03 * random.standard_normal(200)[names] + np.hypot(0.01, 0.02) * random.standard_normal(names.size)
    found = pooled(1.0 + values, np.full(names.size, 0.01), names)
    assert found.within == pytest.approx(0.02, rel=0.15) and found.between == pytest.approx(0.03, rel=0.15)
    same = pooled([1.0] * 6, [0.1] * 6, [1, 1, 2, 2, 3, 3])
    assert (same.within, same.between, same.value) == (0.0, 0.0, 1.0)
