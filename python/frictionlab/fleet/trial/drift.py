"""How soon a degrading joint is found, and how often one that is not is called changed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..drift import changes
from .made import MadeFleet, joints


@dataclass(frozen=True)
class Judged:
    """A made fleet as it was judged."""

    fleet: MadeFleet
    degrading: int
    # Degrading joints that were called changed at or after their change.
    found: int
    # Recordings from the change until it was known: median, and 90 % quantile of those found.
    delay: float
    late: float
    # Joints that were called changed and were not: that do not degrade, or before they did.
    false_alarms: int
    steady: int


def judged(fleet: MadeFleet, false_alarms: float = 0.01) -> Judged:
    """Judges each joint of a made fleet."""
    delays, wrong, degrading = [], 0, 0
    made = joints(fleet)
    for one in made:
        found = changes(one.values, one.errors, one.temperatures, false_alarms=false_alarms)
        alarm = found.alarm if found is not None else None
        degrading += one.begin is not None
        if alarm is None:
            continue
        if one.begin is None or alarm < one.begin:
            wrong += 1
        else:
            delays.append(alarm - one.begin + 1)
    middle, late = np.quantile(delays, [0.5, 0.9]) if delays else (np.nan, np.nan)
    return Judged(fleet, degrading, len(delays), float(middle), float(late), wrong, len(made) - degrading)


def table(seeds: int = 3, false_alarms: float = 0.01) -> str:
    """Fleets of 500 joints with 5 % degrading at several speeds; sums over seeds, as a table in Markdown."""
    lines = [
        "| growth a recording | recordings a joint | degrading joints found | until known, median (90 %) | false alarms |",
        "|---|---|---|---|---|",
    ]
    for growth in (0.0, 0.005, 0.01, 0.02, 0.05):
        for count in (20, 40, 80):
            fleet = MadeFleet(growth=growth, recordings=count)
            several = [judged(replace(fleet, seed=seed + 1), false_alarms) for seed in range(seeds)]
            found, of = sum(one.found for one in several), sum(one.degrading for one in several)
            wrong, steady = sum(one.false_alarms for one in several), sum(one.steady for one in several)
            if growth == 0.0:
                # Nobody degrades: all that is found is found wrongly.
                wrong, steady, shown = wrong + found, steady + of, "|  | "
            else:
                middle, late = (np.nanmedian([getattr(one, name) for one in several]) for name in ("delay", "late"))
                shown = f"| {found} of {of} | {middle:.0f} ({late:.0f}) "
            lines.append(f"| {100 * growth:g} % | {count} {shown}| {wrong} of {steady} ({100 * wrong / steady:.2f} %) |")
    return "\n".join(lines)
