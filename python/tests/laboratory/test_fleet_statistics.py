"""Statements about chance, counted on fleets whose truth is known."""

import os

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("scipy")

from frictionlab.fleet import changes, pooled
from frictionlab.fleet.joints import influences, machines, outliers
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
    outlier = 1.0 + 0.01 * random.standard_normal(n) + 0.5 * (np.arange(n) == 20)
    assert not changes(outlier).changed
    assert not changes(np.ones(30)).changed and changes(np.r_[np.ones(15), 2.0 * np.ones(15)]).changed


@pytest.mark.parametrize(("of", "runs"), [(2, 6), (3, 4), (6, 5), (20, 3), (5, 1), (1, 8)])
def test_intervals_of_pooled_estimates_hold_the_truth(of, runs):
    random, count = np.random.default_rng(4), 300 * TIMES
    held = predicted = 0
    for _ in range(count):
        names = np.repeat(np.arange(of), runs)
        errors = 0.01 * np.exp(0.4 * random.standard_normal(names.size))
        values = 0.02 * random.standard_normal(of)[names] * (of > 1)
        values += np.hypot(errors, 0.01) * random.standard_normal(names.size)
        found = pooled(1.0 + values, errors, names)
        held += found.interval_95[0] <= 1.0 <= found.interval_95[1]
        other = 1.0 + (0.02 if of > 1 else 0.01) * random.standard_normal()
        predicted += found.prediction_95[0] <= other <= found.prediction_95[1]
    assert held / count > 0.95 - 3.0 * np.sqrt(0.0475 / count)
    assert predicted / count > (0.9 if of > 1 else 0.8)


def test_variances_within_and_between_are_told_apart():
    random = np.random.default_rng(5)
    names = np.repeat(np.arange(200), 6)
    values = 0.03 * random.standard_normal(200)[names] + np.hypot(0.01, 0.02) * random.standard_normal(names.size)
    found = pooled(1.0 + values, np.full(names.size, 0.01), names)
    assert found.within == pytest.approx(0.02, rel=0.15) and found.between == pytest.approx(0.03, rel=0.15)
    same = pooled([1.0] * 6, [0.1] * 6, [1, 1, 2, 2, 3, 3])
    assert (same.within, same.between, same.value) == (0.0, 0.0, 1.0)


def test_influences_are_within_joints_with_intervals_that_hold():
    random, held = np.random.default_rng(6), 0
    for _ in range(40 * TIMES):
        rows = []
        for machine in range(8):
            # A machine that is always warm and rubs more says nothing of the temperature.
            level, at = 1.0 + 0.1 * machine, 20.0 + machine
            for run in range(14):
                warm, age = at + 6.0 * np.sin(run / 2.0), 100.0 * run
                value = level * (1.0 - 0.004 * (warm - at) + 0.01 * random.standard_normal())
                rows.append((f"arm{machine}", "", "f_c", value, warm, age))
        columns = ["machine", "joint", "parameter", "value", "temperature_c", "age_h"]
        found = influences(pd.DataFrame(rows, columns=columns)).set_index("of")
        held += found.loc["temperature", "low_95"] <= -0.4 <= found.loc["temperature", "high_95"]
        held += found.loc["age", "low_95"] <= 0.0 <= found.loc["age", "high_95"]
    assert held >= 0.85 * 80 * TIMES


def test_an_outlier_and_a_machine_unlike_the_others_are_named():
    random, rows = np.random.default_rng(7), []
    for machine in range(10):
        level = 1.0 + 0.02 * random.standard_normal() + (0.5 if machine == 4 else 0.0)
        for run in range(10):
            value = level + 0.01 * random.standard_normal() + (0.2 if (machine, run) == (2, 5) else 0.0)
            rows.append((f"{machine}-{run}", f"arm{machine}", "", "f_c", "N m", value, 0.005))
    columns = ["uri", "machine", "joint", "parameter", "unit", "value", "standard_error"]
    estimates = pd.DataFrame(rows, columns=columns)
    assert list(outliers(estimates, 0.01)["uri"]) == ["2-5"]
    compared = machines(estimates, 0.01)
    assert list(compared[compared["unlike"]]["machine"]) == ["arm4"]
