"""A Ray cluster: a task a recording, as many at once as the cluster has processors.

Outcomes are small and come back with the task's answer, so that none is lost with a node. A task whose worker or
node ended is given to another; one that ended several is told as the recording's fault.
"""

from __future__ import annotations

import os
import time
from collections.abc import Generator, Iterable
from typing import Any

from ...errors import BadInput
from ..needs import needed
from ..settings import Settings
from ..work import Outcome, Task, outcome
from . import TRIES, died

# Losses of workers that are no recording's fault (a node goes, memory runs out elsewhere) come together.
LOSSES = 2 * TRIES
# How often the cluster is asked for its size [s].
LOOK = 5.0


class Cluster:
    """Workers of a Ray cluster."""

    def __init__(self, settings: Settings, workers: int | None, address: str | None) -> None:
        ray = needed("ray", "ray")
        self._ray = ray
        self._mine = not ray.is_initialized()
        if self._mine:
            # The workers' own words are in Ray's logs.
            try:
                ray.init(address=address or os.environ.get("RAY_ADDRESS") or None, log_to_driver=False, logging_level="warning")
            except ConnectionError as error:
                raise BadInput(
                    f"there is no Ray cluster at {address or 'auto'}: {error}; `ray start --head` starts one"
                ) from None
        self.workers = workers or max(1, int(ray.cluster_resources().get("CPU", 1)))
        self._given = workers is not None
        self._asked = time.monotonic()
        self._settings = settings

    def outcomes(self, tasks: Iterable[Task]) -> Generator[Outcome, None, None]:
        """See `Engine`."""
        ray = self._ray
        # What is tried again, and how often, is said here: each loss is counted against its recording.
        remote = ray.remote(max_retries=0, num_cpus=1, scheduling_strategy="SPREAD")(outcome)
        settings = ray.put(self._settings)
        waiting = iter(tasks)
        running: dict[Any, tuple[Task, int]] = {}

        def start(task: Task, losses: int) -> None:
            running[remote.remote(settings, task)] = (task, losses)

        try:
            while True:
                # One waits for each that runs, unless it was said how many may.
                room = self.workers if self._given else 2 * self.workers
                while len(running) < room and (task := next(waiting, None)) is not None:
                    start(task, 0)
                if not running:
                    return
                done, _ = ray.wait(list(running), num_returns=1, timeout=0.2)
                for one in done:
                    task, losses = running.pop(one)
                    found = self._told(one, task)
                    if found is not None:
                        yield found
                    elif losses + 1 < LOSSES:
                        start(task, losses + 1)
                    else:
                        yield died(task, LOSSES)
                if not self._given:
                    self._grown()
        finally:
            for one in running:
                ray.cancel(one, force=True)
            if self._mine:
                ray.shutdown()

    def _told(self, one: Any, task: Task) -> Outcome | None:
        """The outcome; none where worker or node went."""
        lost = self._ray.exceptions
        try:
            found: Outcome = self._ray.get(one)
        except (lost.WorkerCrashedError, lost.NodeDiedError, lost.OutOfMemoryError, lost.ObjectLostError):
            return None
        except lost.RayError as error:
            uri = task.recording.uri
            return Outcome(uri, error=f"{uri}: {type(error).__name__}: {str(error).splitlines()[-1]}")
        return found

    def _grown(self) -> None:
        """A cluster gains and loses nodes: it is asked now and then."""
        if time.monotonic() - self._asked < LOOK:
            return
        self._asked = time.monotonic()
        self.workers = max(1, int(self._ray.cluster_resources().get("CPU", self.workers)))
