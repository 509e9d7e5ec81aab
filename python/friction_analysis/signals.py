"""What a live plot shows: the last seconds of every signal and the Stribeck curve of everything heard. Knows no ROS."""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from friction_analysis.stribeck import BinnedCurve

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Recent:
    """Samples of the window: `time` [s] back from the newest sample of all topics, so 0 at the right end and negative before."""

    time: Array
    values: dict[str, Array]

    def __len__(self) -> int:
        return len(self.time)


class Signals:
    """Collects samples from one thread and hands out copies to another.

    `window` [s]: how much of the past is kept. `names`: columns of each topic, in the order that `add` takes them.
    """

    def __init__(self, names: dict[str, tuple[str, ...]], window: float = 10.0) -> None:
        self.names = names
        self.window = window
        self.counts = dict.fromkeys(names, 0)
        self._rows: dict[str, deque[tuple[float, ...]]] = {topic: deque() for topic in names}
        self._curve = BinnedCurve()
        self._pending: list[tuple[float, float]] = []
        self._newest = -np.inf
        self._lock = threading.Lock()

    def add(self, topic: str, time: float, *values: float) -> None:
        """One sample at a time [s]; a topic's times only grow, else the source began anew and its past is dropped."""
        if len(values) != len(self.names[topic]):
            raise ValueError(f"{topic} has {len(self.names[topic])} values, but {len(values)} came")
        with self._lock:
            rows = self._rows[topic]
            if rows and time < rows[-1][0]:
                for others in self._rows.values():
                    others.clear()
                self._newest = -np.inf
            rows.append((time, *values))
            self.counts[topic] += 1
            self._newest = max(self._newest, time)
            while rows and rows[0][0] < self._newest - self.window:
                rows.popleft()

    def add_friction(self, velocity: float, torque: float) -> None:
        """One sample of the Stribeck curve [rad/s, N m]."""
        with self._lock:
            self._pending.append((velocity, torque))
            if len(self._pending) >= 1000:
                self._add_pending()

    def recent(self, topic: str) -> Recent:
        """The topic's samples of the window."""
        with self._lock:
            rows = [row for row in self._rows[topic] if row[0] >= self._newest - self.window]
            newest = self._newest
        table = np.array(rows, dtype=np.float64).reshape(len(rows), 1 + len(self.names[topic]))
        return Recent(table[:, 0] - newest, {name: table[:, 1 + i] for i, name in enumerate(self.names[topic])})

    def curve(self) -> BinnedCurve:
        """The Stribeck curve so far; read it before more is added."""
        with self._lock:
            self._add_pending()
            return self._curve

    def rate(self, topic: str) -> float:
        """Samples a second within the window [Hz]; 0 for fewer than two samples."""
        time = self.recent(topic).time
        if len(time) < 2 or time[-1] <= time[0]:
            return 0.0
        return float((len(time) - 1) / (time[-1] - time[0]))

    def _add_pending(self) -> None:
        if self._pending:
            samples = np.array(self._pending)
            self._curve.add(samples[:, 0], samples[:, 1])
            self._pending.clear()
