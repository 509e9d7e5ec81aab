"""Whether a joint's friction changed: a CUSUM whose false-alarm rate is set, over estimates with their errors.

Each estimate is compared with what the ones before it predict: the recursive residuals of Brown, Durbin and Evans
(1975, Journal of the Royal Statistical Society B 37, 149), weighted by the errors, with the conditions (as the
temperature) as regressors. Divided by the scatter of the residuals before, and brought from Student's to the normal
distribution (the self-starting CUSUM of Hawkins 1987, The Statistician 36, 299), they are independent standard
normal numbers as long as nothing changes, whatever the mean, the scatter and the influence of the conditions are:
no joint needs a history to be judged. None counts for more than three standard deviations, so that an outlier alone
is no change. Their two-sided CUSUM raises the alarm at a limit that chance reaches in the stated share of unchanged
joints over the whole series; the limit is found by simulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from .._given import Floats, numbers
from ..errors import BadInput
from .needs import needed

# Shift that the CUSUM is best at is twice this [standard deviations].
REFERENCE = 0.5
# What one estimate says at most [standard deviations]: a single one that is far off is an outlier and no change.
MOST = 3.0
# Simulated series without a change.
SERIES = 40_000
# Estimates that a series must have to be judged, beyond one for each condition.
LEAST = 6


@dataclass(frozen=True)
class Change:
    """What a series of estimates says of a change."""

    # Whether it changed, wrongly in the share `false_alarms` of series that did not.
    changed: bool
    # How often chance alone gives as much.
    probability_of_chance: float
    # The first estimate that it is known from, and the first that is of the changed joint. None without a change.
    alarm: int | None
    begin: int | None
    # What changed, and its 95 % interval; where nothing did, of the second half against the first.
    difference: float
    interval_95: tuple[float, float]


def changes(
    values: npt.ArrayLike,
    standard_errors: npt.ArrayLike | None = None,
    conditions: npt.ArrayLike | None = None,
    *,
    false_alarms: float = 0.01,
) -> Change | None:
    """Judge a series of estimates in the order of time; none where it is too short.

    `conditions` has a row an estimate and a column a quantity that the parameter may depend on linearly, as the
    temperature. `false_alarms` is the share of unchanged series that are called changed.

    >>> import numpy as np
    >>> noise = 0.01 * np.random.default_rng(1).standard_normal(40)
    >>> steady = changes(1.0 + noise)
    >>> worn = changes(1.0 + noise + 0.05 * (np.arange(40) >= 25))
    >>> steady.changed, worn.changed, worn.begin
    (False, True, 25)
    """
    if not 0.0 < false_alarms < 1.0:
        raise BadInput(f"the share of false alarms must lie between 0 and 1, but is {false_alarms}")
    y = numbers(values, "values")
    known = np.zeros_like(y) if standard_errors is None else numbers(standard_errors, "standard_errors")
    given = np.empty((len(y), 0)) if conditions is None else numbers(conditions, "conditions", (1, 2))
    given = given.reshape(len(given), -1)
    if not len(y) == len(known) == len(given):
        raise BadInput(
            f"there must be as many values as errors and conditions, but there are {len(y)}, {len(known)}, {len(given)}"
        )
    if not (np.isfinite(y).all() and np.isfinite(given).all()):
        raise BadInput("values and conditions must be finite numbers; leave out what has none")
    given = given[:, np.ptp(given, axis=0) > 0.0] if len(given) else given
    if len(y) < LEAST + given.shape[1]:
        return None
    deviations = _deviations(y, known)
    design = np.column_stack([np.ones(len(y)), given - given.mean(axis=0)])
    steps, first = _standardised(y, design, deviations)
    if len(steps) < 3:
        return None
    path, zero = _cusum(steps)
    chance = _by_chance(len(steps))
    chances = (np.sum(chance >= path.max()) + 1) / (SERIES + 1)
    limit = float(np.quantile(chance, 1.0 - false_alarms))
    alarm = int(np.argmax(path > limit)) if (path > limit).any() else None
    begin = first + zero[alarm] if alarm is not None else len(y) // 2
    difference, interval = _difference(y, design, deviations, begin)
    if alarm is None:
        return Change(False, float(chances), None, None, difference, interval)
    return Change(True, float(chances), first + alarm, begin, difference, interval)


def _deviations(y: Floats, errors: Floats) -> Floats:
    """How much each estimate scatters: its own error, and what runs differ by beyond it, from neighbours' differences."""
    usable = np.isfinite(errors) & (errors > 0.0)
    if not usable.any():
        return np.ones_like(y)
    own = np.where(usable, errors, np.median(errors[usable]))
    beyond = float(np.median(np.diff(y) ** 2) / 0.455 - np.median(own[1:] ** 2 + own[:-1] ** 2)) / 2.0
    found: Floats = np.sqrt(own**2 + max(beyond, 0.0))
    return found


def _standardised(y: Floats, design: Floats, deviations: Floats) -> tuple[Floats, int]:
    """Independent standard normal numbers as long as nothing changes, and the place of the first."""
    stats = needed("scipy.stats", "fleet")
    a, b = design / deviations[:, None], y / deviations
    columns = design.shape[1]
    residuals, places = [], []
    for at in range(columns, len(y)):
        before = a[:at]
        gram = before.T @ before
        # Until the conditions have varied, nothing can be said of their influence.
        if np.linalg.cond(gram) > 1e10:
            continue
        found = np.linalg.solve(gram, before.T @ b[:at])
        spread = 1.0 + a[at] @ np.linalg.solve(gram, a[at])
        residuals.append((b[at] - a[at] @ found) / np.sqrt(spread))
        places.append(at)
    r = np.array(residuals)
    if len(r) < 2:
        return np.empty(0), len(y)
    freedom = np.arange(1, len(r))
    scatter = np.sqrt(np.cumsum(r[:-1] ** 2) / freedom)
    # A series without any scatter is as it should be, or far from it.
    t = np.divide(r[1:], scatter, out=np.where(r[1:] == 0.0, 0.0, np.sign(r[1:]) * 1e9), where=scatter > 0.0)
    half = stats.norm.isf(np.maximum(stats.t.sf(np.abs(t), freedom), 1e-15))
    return np.sign(t) * np.minimum(half, MOST), places[1]


def _cusum(steps: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], list[int]]:
    """The larger of both one-sided sums after each step, and from where that one rose from zero."""
    sums, since = [0.0, 0.0], [0, 0]
    path, zero = [], []
    for at, step in enumerate(steps):
        for side, sign in enumerate((1.0, -1.0)):
            sums[side] += sign * step - REFERENCE
            if sums[side] <= 0.0:
                sums[side], since[side] = 0.0, at + 1
        side = int(sums[1] > sums[0])
        path.append(sums[side])
        zero.append(since[side])
    return np.array(path), zero


@lru_cache(maxsize=512)
def _by_chance(length: int) -> Floats:
    """The largest sums of series that do not change; the same for each call."""
    random = np.random.default_rng(length)
    sums, largest = np.zeros((2, SERIES)), np.zeros(SERIES)
    for _ in range(length):
        step = np.clip(random.standard_normal(SERIES), -MOST, MOST)
        sums = np.maximum(sums + np.stack([step, -step]) - REFERENCE, 0.0)
        largest = np.maximum(largest, sums.max(axis=0))
    return largest


def _difference(y: Floats, design: Floats, deviations: Floats, begin: int) -> tuple[float, tuple[float, float]]:
    """The step at a place by least squares, with Student's interval."""
    stats = needed("scipy.stats", "fleet")
    a = np.column_stack([design, np.arange(len(y)) >= begin]) / deviations[:, None]
    b = y / deviations
    found, *_ = np.linalg.lstsq(a, b, rcond=None)
    freedom = max(len(y) - a.shape[1], 1)
    variance = float(np.sum((b - a @ found) ** 2)) / freedom
    error = float(np.sqrt(variance * np.linalg.pinv(a.T @ a)[-1, -1]))
    reach = float(stats.t.ppf(0.975, freedom)) * error
    value = float(found[-1])
    return value, (value - reach, value + reach)
