"""A Ray cluster: tasks in bundles, as many at once as the cluster has processors.

A bundle costs the cluster the same whatever is in it (a place is asked for, the work is fetched, the answer stored),
so one holds as many tasks as take half a second. Outcomes are small and come back with the answer, so that none is
lost with a node. A bundle whose worker or node ended is given to others task by task; a task that ended several
workers by itself is told as its own fault.
"""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from contextlib import suppress
from itertools import islice
from typing import Any, Generic, NamedTuple

from ...errors import BadInput
from ..needs import needed
from . import TRIES, R, T, Work, died

# Losses of workers that are no task's fault (a node goes, memory runs out elsewhere) come together.
LOSSES = 2 * TRIES
# How often the cluster is asked for its size [s].
LOOK = 5.0
# How long a bundle is to take [s], and the most tasks in it.
BUNDLE_S = 0.5
MOST = 100


class _Bundle(NamedTuple):
    """Tasks that go to a worker together, and how often one with them was lost."""

    tasks: list[Any]
    losses: int


class Cluster(Generic[T, R]):
    """Workers of a Ray cluster."""

    def __init__(self, work: Work[T, R], workers: int | None, address: str | None) -> None:
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
        self._work = work
        # What a task takes [s], as far as it is known.
        self._each: float | None = None

    def outcomes(self, tasks: Iterable[T]) -> Generator[R, None, None]:
        """See `Engine`."""
        ray = self._ray
        # What is tried again, and how often, is said here: each loss is counted against its task.
        remote = ray.remote(max_retries=0, num_cpus=1, scheduling_strategy="SPREAD")(friction_fleet)
        work = ray.put(self._work)
        waiting, again = iter(tasks), deque[_Bundle]()
        running: dict[Any, _Bundle] = {}
        try:
            while True:
                # One waits for each that runs, unless it was said how many may.
                room = self.workers if self._given else 2 * self.workers
                while len(running) < room and (bundle := again.popleft() if again else self._next(waiting)):
                    running[remote.remote(work, bundle.tasks)] = bundle
                if not running:
                    return
                done, _ = ray.wait(list(running), num_returns=1, timeout=0.2)
                for one in done:
                    bundle = running.pop(one)
                    found = self._told(one, bundle)
                    if found is not None:
                        yield from found
                    elif bundle.losses + 1 < LOSSES:
                        # Whose fault it was is seen when each is alone.
                        losses = bundle.losses + 1 if len(bundle.tasks) == 1 else 0
                        again.extend(_Bundle([task], losses) for task in bundle.tasks)
                    else:
                        yield self._work.failed(bundle.tasks[0], died(LOSSES))
                if not self._given:
                    self._grown()
        finally:
            try:
                for one in running:
                    # What ended meanwhile needs no end.
                    with suppress(ray.exceptions.RayError, ValueError):
                        ray.cancel(one, force=True)
            finally:
                if self._mine:
                    ray.shutdown()

    def _next(self, waiting: Iterator[T]) -> _Bundle | None:
        """The next tasks; none where there are no more."""
        size = 1 if self._each is None else max(1, min(MOST, int(BUNDLE_S / max(self._each, 1e-6))))
        bundle = list(islice(waiting, size))
        return _Bundle(bundle, 0) if bundle else None

    def _told(self, one: Any, bundle: _Bundle) -> list[R] | None:
        """The outcomes; none where worker or node went."""
        lost = self._ray.exceptions
        try:
            found: list[R]
            found, seconds = self._ray.get(one)
        except (lost.WorkerCrashedError, lost.NodeDiedError, lost.OutOfMemoryError, lost.ObjectLostError):
            return None
        except lost.RayError as error:
            why = f"{type(error).__name__}: {str(error).splitlines()[-1]}"
            return [self._work.failed(task, why) for task in bundle.tasks]
        each = seconds / len(found)
        # What comes now tells more than what came before.
        self._each = each if self._each is None else 0.7 * self._each + 0.3 * each
        return found

    def _grown(self) -> None:
        """A cluster gains and loses nodes: it is asked now and then."""
        if time.monotonic() - self._asked < LOOK:
            return
        self._asked = time.monotonic()
        self.workers = max(1, int(self._ray.cluster_resources().get("CPU", self.workers)))


def friction_fleet(work: Work[T, R], tasks: list[T]) -> tuple[list[R], float]:
    """What a worker does with a bundle; the outcomes, and how long they took [s]. Workers are called by its name."""
    began = time.monotonic()
    return [work.do(task) for task in tasks], time.monotonic() - began
