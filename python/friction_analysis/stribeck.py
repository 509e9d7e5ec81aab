"""The Stribeck curve from samples, without a fit: mean friction torque over logarithmic bins of velocity."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pandas as pd

Array = npt.NDArray[np.float64]


class BinnedCurve:
    """Samples of friction torque sorted by velocity into bins, added up as they come.

    Every direction of motion has bins of its own, equally wide on a logarithmic scale from `smallest` to `largest` [rad/s].
    Slower samples, and those that are no numbers, are left out: near standstill the torque is the spring's of pre-sliding,
    and the sign of a noisy velocity is not known. A bin's point is independent of the order of its samples.

    Noise of the velocity moves samples into neighbouring bins: below three standard deviations of it the curve is smeared.
    `block_means` of slow motion help.
    """

    def __init__(self, smallest: float = 1e-3, largest: float = 100.0, per_decade: int = 12) -> None:
        if not 0.0 < smallest < largest < np.inf:
            raise ValueError(f"0 < smallest < largest was expected, but {smallest} and {largest} came")
        if per_decade < 1:
            raise ValueError(f"one bin a decade at least was expected, but {per_decade} came")
        self.smallest = smallest
        self.largest = largest
        self._scale = per_decade
        self._half = int(np.ceil(np.log10(largest / smallest) * per_decade - 1e-9))
        # Rows: count, sum of velocities, sum of torques, mean torque and sum of squared deviations from it.
        self._count = np.zeros(2 * self._half)
        self._velocity = np.zeros(2 * self._half)
        self._mean = np.zeros(2 * self._half)
        self._squares = np.zeros(2 * self._half)

    def add(self, velocity: npt.ArrayLike, torque: npt.ArrayLike) -> None:
        """Adds samples: velocity [rad/s] and friction torque [N m], positive against positive velocity; equal shapes."""
        v = np.atleast_1d(np.asarray(velocity, dtype=np.float64))
        f = np.atleast_1d(np.asarray(torque, dtype=np.float64))
        if v.shape != f.shape:
            raise ValueError(f"as many torques as velocities were expected, but {f.shape} and {v.shape} came")
        speed = np.abs(v)
        kept = np.isfinite(v) & np.isfinite(f) & (speed >= self.smallest) & (speed < self.largest)
        v, f, speed = v[kept], f[kept], speed[kept]
        step = np.floor(np.log10(speed / self.smallest) * self._scale).astype(np.int64)
        step = np.clip(step, 0, self._half - 1)
        # Backwards from fast to slow, then forwards from slow to fast: the points come out sorted by velocity.
        bins = np.where(v > 0.0, self._half + step, self._half - 1 - step)
        size = 2 * self._half
        count = np.bincount(bins, minlength=size).astype(np.float64)
        here = count > 0
        mean = np.zeros(size)
        mean[here] = np.bincount(bins, weights=f, minlength=size)[here] / count[here]
        squares = np.bincount(bins, weights=(f - mean[bins]) ** 2, minlength=size)
        # Two sets of samples are put together by their means (Chan, Golub, LeVeque 1983): no difference of large sums.
        total = self._count + count
        share = np.divide(count, total, out=np.zeros(size), where=total > 0)
        apart = mean - self._mean
        self._squares += squares + apart**2 * self._count * share
        self._mean += apart * share
        self._velocity += np.bincount(bins, weights=v, minlength=size)
        self._count = total

    def points(self, min_count: int = 5) -> pd.DataFrame:
        """The curve, one row a bin that has at least `min_count` samples, sorted by velocity.

        Columns: `velocity_rad_s` and `torque_Nm` (means of the bin's samples), `deviation_Nm` (standard deviation of its
        torques; not a number for one sample), `count`.
        """
        kept = self._count >= max(min_count, 1)
        count = self._count[kept]
        freedom = np.where(count > 1, count - 1, np.nan)
        return pd.DataFrame(
            {
                "velocity_rad_s": self._velocity[kept] / count,
                "torque_Nm": self._mean[kept],
                "deviation_Nm": np.sqrt(self._squares[kept] / freedom),
                "count": count.astype(np.int64),
            }
        )


def binned(
    velocity: npt.ArrayLike,
    torque: npt.ArrayLike,
    smallest: float = 1e-3,
    per_decade: int = 12,
    min_count: int = 5,
) -> pd.DataFrame:
    """The curve of all samples at once; see `BinnedCurve` for arguments and columns."""
    curve = BinnedCurve(smallest=smallest, per_decade=per_decade)
    curve.add(velocity, torque)
    return curve.points(min_count)


def block_means(table: pd.DataFrame, width: float) -> pd.DataFrame:
    """Means of the numeric columns over blocks of `width` [s] of the index `t_s`; blocks without samples are left out."""
    if not 0.0 < width < np.inf:
        raise ValueError(f"a width above 0 was expected, but {width} came")
    numbers = table.select_dtypes(include=["number"])
    blocks = np.floor(np.asarray(numbers.index, dtype=np.float64) / width + 1e-9)
    means = numbers.groupby(blocks).mean()
    means.index = pd.Index((means.index.to_numpy(dtype=np.float64) + 0.5) * width, name="t_s")
    return means


def steady_point(table: pd.DataFrame, travel: float) -> tuple[float, float, float] | None:
    """Mean velocity, mean torque and the torque's standard deviation of a run at constant velocity.

    The first fifth and the last tenth do not count; nothing where less than `travel` [rad] is left.
    """
    time = np.asarray(table.index, dtype=np.float64)
    if len(time) < 20:
        return None
    length = time[-1] - time[0]
    kept = table[(time >= time[0] + 0.2 * length) & (time <= time[-1] - 0.1 * length)]
    velocity, torque = (kept[name].to_numpy(dtype=np.float64) for name in ("velocity_rad_s", "torque_Nm"))
    if len(kept) < 5 or not abs(velocity.mean()) * 0.7 * length > travel:
        return None
    return float(velocity.mean()), float(torque.mean()), float(torque.std())


def sliding(table: pd.DataFrame, width: float, travel: float) -> pd.DataFrame:
    """Means over blocks of `width` [s] of velocity and torque while the shaft slides.

    Left out are blocks slower than three times their own noise, and the first `travel` [rad] after each such block and each
    turn.
    """
    velocity = table["velocity_rad_s"].to_numpy(dtype=np.float64)
    means = block_means(table, width)
    if len(means) < 2 or len(velocity) < 3:
        return means.iloc[:0]
    # The noise is what neighbouring samples differ by; motion differs by far less.
    noise = 1.4826 * float(np.median(np.abs(np.diff(velocity)))) / np.sqrt(2.0)
    threshold = 3.0 * noise / np.sqrt(max(1.0, len(velocity) / len(means)))
    speed = means["velocity_rad_s"].to_numpy(dtype=np.float64)
    direction = np.where(np.abs(speed) > threshold, np.sign(speed), 0.0)
    time = np.asarray(means.index, dtype=np.float64)
    way = np.concatenate([[0.0], np.cumsum(np.abs(speed[1:]) * np.minimum(np.diff(time), 2.0 * width))])
    turned = np.concatenate([[True], direction[1:] != direction[:-1]])
    since = way - np.maximum.accumulate(np.where(turned, way, 0.0))
    kept: pd.DataFrame = means[(direction != 0.0) & (since >= travel)]
    return kept
