"""One estimate of many: over the runs of a machine, and over machines.

The model has three levels: a run's estimate scatters by its own standard error about the value of that run, runs
scatter about the value of their machine (within), machines about that of all (between). Both variances are those of
Paule and Mandel (1982, Journal of Research of the National Bureau of Standards 87, 377), which ask for no normal
distribution (Veroniki and others 2016, Research Synthesis Methods 7, 55). The interval of the mean is that of Hartung
and Knapp (2001, Statistics in Medicine 20, 3875), never narrower than with the errors taken as known, which is safer
with few machines.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from .._given import Floats, numbers
from ..errors import BadInput
from .needs import needed

Places: TypeAlias = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Pooled:
    """An estimate over runs and machines."""

    value: float
    standard_error: float
    # Low and high end, with 95 % between them. Open with one run alone.
    interval_95: tuple[float, float]
    # Where another machine lies (Higgins, Thompson and Spiegelhalter 2009); with one machine alone, another run. It holds
    # in somewhat less than 95 % of the cases where few scatter no more than their errors, as their scatter is a guess.
    prediction_95: tuple[float, float]
    # Standard deviation of runs of one machine, beyond their own errors. None where no machine has two runs.
    within: float | None
    # Standard deviation of machines. None with one machine.
    between: float | None
    runs: int
    machines: int


def pooled(
    values: npt.ArrayLike, standard_errors: npt.ArrayLike, machines: Sequence[Any] | npt.ArrayLike | None = None
) -> Pooled:
    """Pool estimates of one parameter, one a run, with their standard errors; `machines` says whose each is.

    >>> found = pooled([0.10, 0.12, 0.20, 0.22], [0.005] * 4, ["a", "a", "b", "b"])
    >>> round(found.value, 3), found.machines
    (0.16, 2)
    """
    y, s = numbers(values, "values"), numbers(standard_errors, "standard_errors")
    names = np.zeros(len(y), dtype=np.int64)
    if machines is not None:
        names = np.unique(np.asarray(machines), return_inverse=True)[1]
    if not len(y) == len(s) == len(names):
        raise BadInput(
            f"there must be as many values as standard errors and machines, but there are {len(y)}, {len(s)}, {len(names)}"
        )
    if len(y) == 0:
        raise BadInput("there is no estimate to pool")
    if not (np.isfinite(y).all() and np.isfinite(s).all() and (s >= 0).all()):
        raise BadInput("values must be finite numbers, and standard errors finite and not below zero")
    count = int(names.max()) + 1
    if count == 1:
        # The runs of one machine are pooled as machines would be.
        found = _levels(y, s, np.arange(len(y)))
        within = found.between
        return Pooled(found.value, found.standard_error, found.interval_95, found.prediction_95, within, None, len(y), 1)
    return _levels(y, s, names)


def _levels(y: Floats, s: Floats, names: Places) -> Pooled:
    counts = np.bincount(names)
    k = len(counts)
    several = int(counts.max()) > 1
    within = _variance(lambda variance: _within(y, s, names, variance), len(y) - k, y) if several else 0.0
    weights = 1.0 / np.maximum(s**2 + within, 1e-300)
    each = np.bincount(names, weights)
    means = np.bincount(names, weights * y) / each
    if k == 1:
        nothing = (-np.inf, np.inf)
        return Pooled(float(means[0]), float(each[0] ** -0.5), nothing, nothing, None, None, len(y), k)
    between = _variance(lambda variance: _about_mean(means, 1.0 / (1.0 / each + variance)), k - 1, means)
    precisions = 1.0 / (1.0 / each + between)
    total = precisions.sum()
    value = float(precisions @ means / total)
    excess = _about_mean(means, precisions) / (k - 1)
    error = float(np.sqrt(max(excess, 1.0) / total))
    student = needed("scipy.stats", "fleet").t
    quantile = float(student.ppf(0.975, k - 1))
    reach = float(student.ppf(0.975, max(k - 2, 1))) * float(np.sqrt(between + error**2))
    return Pooled(
        value,
        error,
        (value - quantile * error, value + quantile * error),
        (value - reach, value + reach),
        float(within**0.5) if several else None,
        float(between**0.5),
        len(y),
        k,
    )


def _within(y: Floats, s: Floats, names: Places, variance: float) -> float:
    """Weighted squares of the runs about the means of their machines."""
    weights = 1.0 / np.maximum(s**2 + variance, 1e-300)
    means = np.bincount(names, weights * y) / np.bincount(names, weights)
    return float(weights @ (y - means[names]) ** 2)


def _about_mean(means: Floats, precisions: Floats) -> float:
    """Weighted squares of the machines about the mean of all."""
    return float(precisions @ (means - precisions @ means / precisions.sum()) ** 2)


def _variance(squares: Callable[[float], float], freedom: int, y: Floats) -> float:
    """The variance with which the weighted squares are as many as their degrees of freedom; they fall with it."""
    low, high = 0.0, float(np.ptp(y)) ** 2
    if high == 0.0 or squares(0.0) <= freedom:
        return 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if squares(middle) > freedom else (low, middle)
    return high
