"""What the estimates of a fleet say: of each joint, of temperature and age, of single recordings, of machines."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from .drift import changes
from .needs import needed
from .pooled import pooled

if TYPE_CHECKING:
    import pandas as pd

JOINT = ["machine", "joint"]
# Estimates of a joint from which a single one can be told to be unlike the others; machines likewise.
LEAST = 5


def _series(estimates: pd.DataFrame, by: list[str]) -> Iterator[tuple[dict[str, Any], pd.DataFrame]]:
    for key, rows in estimates.groupby(by, sort=True):
        yield dict(zip(by, key if isinstance(key, tuple) else (key,), strict=True)), rows


def _frame(rows: list[dict[str, Any]], columns: list[str]) -> pd.DataFrame:
    import pandas as pd

    frame = pd.DataFrame(rows, columns=columns)
    # So that no rows are no rows of yes and no.
    kinds = {name: bool for name in ("changed", "judged", "unlike") if name in columns}
    return frame.astype(kinds)


def _errors(rows: pd.DataFrame) -> Any:
    """Standard errors; where there is none, one like those of the others."""
    errors = rows["standard_error"].to_numpy(dtype=np.float64, copy=True)
    known = errors[np.isfinite(errors)]
    errors[~np.isfinite(errors)] = np.median(known) if len(known) else 0.0
    return errors


def joints(estimates: pd.DataFrame, false_alarms: float) -> pd.DataFrame:
    """See `Fleet.joints`."""
    columns = [*JOINT, "model", "parameter", "unit", "runs", "value", "standard_error", "low_95", "high_95", "within"]
    columns += [
        "judged",
        "changed",
        "probability_of_chance",
        "known_from",
        "begins",
        "difference",
        "difference_low_95",
        "difference_high_95",
    ]
    found = []
    # A joint with several parameters has no more false alarms than one with a single one.
    several = estimates.groupby(JOINT)["parameter"].nunique()
    ordered = len(estimates) > 0 and (estimates["time"].notna().all() or estimates["age_h"].notna().all())
    for key, rows in _series(estimates, [*JOINT, "parameter"]):
        errors = _errors(rows)
        one = pooled(rows["value"], errors)
        share = false_alarms / int(several[(key["machine"], key["joint"])])
        warm = rows["temperature_c"].to_numpy(dtype=np.float64)
        conditions = warm[:, None] if np.isfinite(warm).all() else None
        change = changes(rows["value"], errors, conditions, false_alarms=share) if ordered else None
        row: dict[str, Any] = key | {"model": rows["model"].iloc[0], "unit": rows["unit"].iloc[0], "runs": one.runs}
        row |= {"value": one.value, "standard_error": one.standard_error, "within": one.within, "judged": change is not None}
        row["low_95"], row["high_95"] = one.interval_95
        if change is not None:
            row |= {
                "changed": change.changed,
                "probability_of_chance": change.probability_of_chance,
                "difference": change.difference,
            }
            row["difference_low_95"], row["difference_high_95"] = change.interval_95
            row["known_from"] = None if change.alarm is None else rows["uri"].iloc[change.alarm]
            row["begins"] = None if change.begin is None else rows["uri"].iloc[change.begin]
        else:
            row["changed"] = False
        found.append(row)
    return _frame(found, columns)


def influences(estimates: pd.DataFrame) -> pd.DataFrame:
    """See `Fleet.influences`. Within joints, so that a joint that is always warm says nothing; errors by joint."""
    stats = needed("scipy.stats", "fleet")
    columns = ["joint", "parameter", "of", "unit", "slope", "low_95", "high_95", "joints", "runs"]
    found = []
    for key, rows in _series(estimates, ["joint", "parameter"]):
        known = [name for name in ("temperature_c", "age_h") if rows[name].notna().mean() > 0.5]
        rows = rows.dropna(subset=known)
        parts = []
        for machine, one in rows.groupby("machine"):
            level = abs(one["value"].mean())
            if len(one) < 3 or level == 0.0:
                continue
            centred = one[known] - one[known].mean()
            parts.append(
                (
                    machine,
                    100.0 * (one["value"] / level - one["value"].mean() / level).to_numpy(),
                    centred.to_numpy(dtype=np.float64),
                )
            )
        if len(parts) < 2 or not known:
            continue
        x, y = np.concatenate([part[2] for part in parts]), np.concatenate([part[1] for part in parts])
        varied = np.ptp(x, axis=0) > 0.0
        if not varied.any() or np.linalg.matrix_rank(x[:, varied]) < varied.sum():
            continue
        x = x[:, varied]
        bread = np.linalg.inv(x.T @ x)
        slope = bread @ x.T @ y
        scores = np.array([part[2][:, varied].T @ (part[1] - part[2][:, varied] @ slope) for part in parts])
        k = len(parts)
        covariance = bread @ (scores.T @ scores) @ bread * k / (k - 1)
        reach = stats.t.ppf(0.975, k - 1) * np.sqrt(np.diag(covariance))
        for name, value, half in zip(np.array(known)[varied], slope, reach, strict=True):
            factor, unit = (1.0, "% a kelvin") if name == "temperature_c" else (1000.0, "% in 1000 h")
            row = {"of": "temperature" if name == "temperature_c" else "age", "unit": unit, "slope": factor * value}
            row |= {"low_95": factor * (value - half), "high_95": factor * (value + half), "joints": k, "runs": len(y)}
            found.append(key | row)
    return _frame(found, columns)


def outliers(estimates: pd.DataFrame, false_alarms: float) -> pd.DataFrame:
    """See `Fleet.outliers`: the deleted residuals of Student, at a limit for all of them at once (Bonferroni)."""
    columns = ["uri", *JOINT, "parameter", "value", "expected", "unit", "times"]
    found = []
    for key, rows in _series(estimates, [*JOINT, "parameter"]):
        if len(rows) < LEAST:
            continue
        expected, t = _against_others(rows["value"].to_numpy(dtype=np.float64), _errors(rows))
        limit = _limit(false_alarms / max(len(estimates), 1), len(rows) - 2)
        for at in np.flatnonzero(np.abs(t) > limit):
            row = rows.iloc[at]
            told = {
                "uri": row["uri"],
                "value": row["value"],
                "unit": row["unit"],
                "expected": expected[at],
                "times": row["value"] / expected[at],
            }
            found.append(key | told)
    return _frame(found, columns)


def machines(estimates: pd.DataFrame, false_alarms: float) -> pd.DataFrame:
    """See `Fleet.machines`."""
    columns = ["machine", "joint", "parameter", "unit", "runs", "value", "low_95", "high_95", "expected", "unlike"]
    found = []
    for key, rows in _series(estimates, ["joint", "parameter"]):
        each = [(name, pooled(one["value"], _errors(one))) for name, one in rows.groupby("machine")]
        if len(each) < LEAST:
            continue
        values = np.array([one.value for _, one in each])
        expected, t = _against_others(values, np.zeros(len(each)))
        limit = _limit(false_alarms / len(each), len(each) - 2)
        for at, (name, one) in enumerate(each):
            row = {"machine": name, "unit": rows["unit"].iloc[0], "runs": one.runs, "value": one.value, "expected": expected[at]}
            row["low_95"], row["high_95"] = one.interval_95
            found.append(key | row | {"unlike": bool(abs(t[at]) > limit)})
    return _frame(found, columns)


def over_machines(estimates: pd.DataFrame) -> pd.DataFrame:
    """See `Fleet.pooled`."""
    columns = ["joint", "parameter", "unit", "value", "standard_error", "low_95", "high_95", "within", "between"]
    columns += ["another_low_95", "another_high_95", "runs", "machines"]
    found = []
    for key, rows in _series(estimates, ["joint", "parameter"]):
        one = pooled(rows["value"], _errors(rows), rows["machine"])
        row: dict[str, Any] = {"unit": rows["unit"].iloc[0], "value": one.value, "standard_error": one.standard_error}
        row["low_95"], row["high_95"] = one.interval_95
        row["another_low_95"], row["another_high_95"] = one.prediction_95
        row |= {"within": one.within, "between": one.between, "runs": one.runs, "machines": one.machines}
        found.append(key | row)
    return _frame(found, columns)


def _against_others(values: Any, errors: Any) -> tuple[Any, Any]:
    """What the others say of each value, and its distance from that in units that Student's t is in."""
    spread = np.var(values, ddof=1)
    # The part of the scatter that their own errors do not explain is common to all.
    common = max(float(spread - np.mean(errors**2)), 0.0)
    weights = 1.0 / np.maximum(errors**2 + common, 1e-300) if (errors**2 + common > 0.0).all() else np.ones(len(values))
    total, n = weights.sum(), len(values)
    rest = total - weights
    expected = (weights @ values - weights * values) / rest
    squares = np.array([np.delete(weights, at) @ np.delete(values - expected[at], at) ** 2 for at in range(n)])
    variance = squares / (n - 2) * (1.0 / weights + 1.0 / rest)
    distance = values - expected
    return expected, np.divide(distance, np.sqrt(variance), out=np.zeros(n), where=variance > 0.0)


def _limit(chance: float, freedom: int) -> float:
    stats = needed("scipy.stats", "fleet")
    return float(stats.t.isf(chance / 2.0, freedom))
