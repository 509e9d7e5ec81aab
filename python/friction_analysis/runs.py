"""The runs in a bag, told apart by pauses in the recording and by what `/experiment_status` says begins."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pandas as pd

from friction_analysis.bag import Bag

# A pause is this long at least [s], and this many of the usual periods.
PAUSE = 0.5
PAUSE_PERIODS = 20.0


@dataclass(frozen=True)
class Run:
    """One motion from its beginning to its end."""

    number: int
    """Its place in the bag, from 1."""
    start_s: float
    """Its first sample [s since the bag's first message]."""
    stop_s: float
    """Its last sample [s since the bag's first message]."""
    experiment: str
    """What `/experiment_status` calls the experiment; empty where it says nothing."""
    stage: str
    """What it calls the stage, as in `compensation lugre`; empty where it says nothing."""

    @property
    def label(self) -> str:
        """Experiment and stage in short, or the number."""
        return self.stage.removeprefix("compensation ") or self.experiment or f"run {self.number}"


def runs_of(bag: Bag, namespace: str = "") -> list[Run]:
    """The runs in their order.

    A run ends where its samples pause for 0.5 s and for twenty of their periods, and where an experiment or a stage begins.
    """
    name = next((name for name in ("controller_state", "joint_states") if bag.has(name, namespace)), None)
    if name is None:
        return []
    time = np.asarray(bag.table(name, namespace).index, dtype=np.float64)
    begins = {0}
    if len(time) > 1:
        steps = np.diff(time)
        begins |= {int(place) + 1 for place in np.flatnonzero((steps > PAUSE) & (steps > PAUSE_PERIODS * np.median(steps)))}
    marks = _marks(bag, namespace)
    previous = ("", "")
    for at, what in marks:
        # A mark between two samples is of the later one.
        place = int(np.searchsorted(time, at - 1e-6))
        if what != previous and place < len(time):
            begins.add(place)
        previous = what
    edges = [*sorted(begins), len(time)]
    runs = []
    for number, (begin, end) in enumerate(pairwise(edges), start=1):
        known = [what for at, what in marks if at <= time[begin] + 1e-6]
        experiment, stage = known[-1] if known else ("", "")
        runs.append(Run(number, float(time[begin]), float(time[end - 1]), experiment, stage))
    return runs


def _marks(bag: Bag, namespace: str) -> list[tuple[float, tuple[str, str]]]:
    """When which experiment and stage began [s since the bag's first message]."""
    if not bag.has("experiment_status", namespace):
        return []
    table = bag.table("experiment_status", namespace)
    whats = zip(table["experiment"], table["stage"], strict=True)
    return [(float(at), (str(experiment), str(stage))) for at, (experiment, stage) in zip(table.index, whats, strict=True)]


def part(bag: Bag, run: Run) -> Bag:
    """The bag's samples of one run, their times from its start."""
    topics = {}
    for topic, table in bag.topics.items():
        index = np.asarray(table.index, dtype=np.float64)
        kept = table[(index >= run.start_s - 1e-6) & (index <= run.stop_s + 1e-6)]
        if len(kept):
            # Nanoseconds: a difference of floats has digits behind them that mean nothing.
            kept = kept.set_axis(pd.Index((np.asarray(kept.index) - run.start_s).round(9), name="t_s"), axis=0)
            topics[topic] = kept
    return replace(bag, topics=topics, types={topic: bag.types[topic] for topic in topics})


def constant_reference(bag: Bag, namespace: str = "") -> float | None:
    """The velocity at which the run of this bag was driven [rad/s], if that was one and the same; see `part`."""
    if not bag.has("controller_state", namespace):
        return None
    state = bag.table("controller_state", namespace)
    reference: npt.NDArray[np.float64] = state["reference"].to_numpy(dtype=np.float64)
    if (state["mode"] != 0).any() or len(reference) < 20 or np.ptp(reference) != 0.0:
        return None
    return float(reference[0])


def chosen(runs: list[Run], most: int) -> list[Run]:
    """At most `most` runs of one experiment: the first of every stage if these are few enough, else some spread over all."""
    if len(runs) <= most:
        return runs
    firsts = list({run.stage: run for run in reversed(runs)}.values())[::-1]
    if max(2, most // 2) <= len(firsts) <= most:
        return sorted(firsts, key=lambda run: run.number)
    return [runs[round(place)] for place in np.linspace(0, len(runs) - 1, most)]
