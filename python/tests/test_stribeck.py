import numpy as np
import pandas as pd
import pytest

from friction_analysis import BinnedCurve, binned
from friction_analysis.stribeck import block_means


def stribeck(velocity):
    """Stribeck curve of the thesis's test bed, f_s 0.0994, f_c 0.0925, v_s 0.1407, f_v 0.0403."""
    speed = np.abs(velocity)
    level = 0.0925 + (0.0994 - 0.0925) * np.exp(-((speed / 0.1407) ** 2))
    return np.sign(velocity) * (level + 0.0403 * speed)


def samples(count=200_000, noise=0.002, seed=3):
    rng = np.random.default_rng(seed)
    velocity = 10.0 ** rng.uniform(-2.5, 1.0, count) * rng.choice([-1.0, 1.0], count)
    return velocity, stribeck(velocity) + rng.normal(0.0, noise, count)


def test_bins_follow_a_known_curve_within_their_standard_error():
    velocity, torque = samples()
    points = binned(velocity, torque)
    # A bin is 21 % wide: the mean of the curve over it is the curve at its mean velocity but for its curvature.
    error = points["torque_Nm"] - stribeck(points["velocity_rad_s"].to_numpy())
    assert len(points) == 2 * 42, "twelve a decade over 3.5 decades, both directions"
    assert error.abs().max() < 4.5 * 0.002 / np.sqrt(points["count"].min()) + 3e-5
    assert points["velocity_rad_s"].is_monotonic_increasing
    slow = points[points["velocity_rad_s"].abs() < 0.1]
    assert np.allclose(slow["deviation_Nm"], 0.002, rtol=0.1)


def test_points_do_not_depend_on_order_or_on_how_samples_come():
    velocity, torque = samples(5000)
    torque = torque + 1e6  # Large against its scatter: differences of sums of squares would lose it.
    whole = binned(velocity, torque)
    order = np.random.default_rng(1).permutation(len(velocity))
    curve = BinnedCurve()
    for part in np.array_split(order, 37):
        curve.add(velocity[part], torque[part])
    pieces = curve.points()
    assert (whole["count"] == pieces["count"]).all()
    assert np.allclose(whole, pieces, rtol=1e-6)


def test_directions_are_not_mixed():
    velocity, torque = samples(20_000)
    forwards = binned(velocity, torque)
    backwards = binned(-velocity, -torque).iloc[::-1].reset_index(drop=True)
    assert np.allclose(forwards["torque_Nm"], -backwards["torque_Nm"], rtol=1e-12)
    assert np.allclose(forwards["velocity_rad_s"], -backwards["velocity_rad_s"], rtol=1e-12)


def test_standstill_and_what_is_no_number_are_left_out():
    points = binned([0.0, 1e-5, np.nan, 1.0, 1.0, np.inf, 1.0], [5.0, 5.0, 5.0, 0.1, np.nan, 5.0, 0.3], min_count=1)
    assert points["count"].tolist() == [2]
    assert points["torque_Nm"].tolist() == [pytest.approx(0.2)]
    assert points["deviation_Nm"].iloc[0] == pytest.approx(0.1 * np.sqrt(2.0))
    assert len(binned([], [])) == 0


def test_wrong_input_is_told():
    with pytest.raises(ValueError, match="as many torques"):
        binned([1.0, 2.0], [1.0])
    with pytest.raises(ValueError, match="smallest < largest"):
        BinnedCurve(smallest=0.0)


def test_block_means_do_not_reach_over_gaps():
    index = pd.Index(np.concatenate([np.arange(100), 1000 + np.arange(100)]) * 1e-3, name="t_s")
    table = pd.DataFrame({"x": np.concatenate([np.zeros(100), np.ones(100)]), "text": "a"}, index=index)
    means = block_means(table, 0.05)
    assert means["x"].tolist() == [0.0, 0.0, 1.0, 1.0]
    assert means.index.to_numpy() == pytest.approx([0.025, 0.075, 1.025, 1.075])
