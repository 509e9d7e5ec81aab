"""The cores of this machine: a process a core, each watched by a thread.

A process that a task ends (out of memory, a crash in a reader) takes no other task with it. Processes
are started by their module and not by a copy of the caller, so that a script or a notebook needs no guard.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Generator, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from itertools import islice
from typing import Any, Generic

from ...errors import Failure
from . import TRIES, R, T, Work, died

# How much longer than its own limit a process is waited for [s].
GRACE = 30.0
# How often it is looked for such processes [s].
LOOK = 1.0


class Local(Generic[T, R]):
    """Processes on this machine."""

    def __init__(self, work: Work[T, R], workers: int | None) -> None:
        self.workers = workers or _cores()
        self._work = work

    def outcomes(self, tasks: Iterable[T]) -> Generator[R, None, None]:
        """See `Engine`."""
        waiting = iter(tasks)
        processes = _Processes(self._work)
        threads = ThreadPoolExecutor(self.workers, thread_name_prefix="friction-fleet")
        running: set[Future[R]] = set()
        try:
            while True:
                room = 2 * self.workers - len(running)
                running |= {threads.submit(processes.work, task) for task in islice(waiting, room)}
                if not running:
                    return
                # Ctrl-C is heard between two looks, on every system.
                done, running = wait(running, timeout=0.2, return_when=FIRST_COMPLETED)
                for one in done:
                    yield one.result()
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
            processes.end()


class _Processes(Generic[T, R]):
    """A process for each thread, made when it is first wanted."""

    def __init__(self, work: Work[T, R]) -> None:
        self._work = work
        self._mine = threading.local()
        self._all: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._ended = False
        # When each process that works is ended.
        self._until: dict[subprocess.Popen[bytes], float] = {}
        self._over = threading.Event()
        threading.Thread(target=self._watch, name="friction-fleet-watch", daemon=True).start()

    def _watch(self) -> None:
        """Ends processes that work for too long: one thread for all tasks, because a thread a task costs more than a small task."""
        while not self._over.wait(LOOK):
            now = time.monotonic()
            for process, until in list(self._until.items()):
                if now > until:
                    process.kill()

    def work(self, task: T) -> R:
        """The outcome of a task, by the process of this thread."""
        for _ in range(TRIES):
            try:
                process = self._process()
                # The limit of the work itself may not be heard in the middle of a library's call.
                self._until[process] = time.monotonic() + self._work.longest_s + GRACE
                try:
                    _send(process.stdin, task)
                    found: R = pickle.load(process.stdout)  # type: ignore[arg-type]
                finally:
                    del self._until[process]
                return found
            except (EOFError, OSError, pickle.UnpicklingError):
                self._gone()
                if self._ended:
                    break
        return self._work.failed(task, died(TRIES))

    def _process(self) -> subprocess.Popen[bytes]:
        process: subprocess.Popen[bytes] | None = getattr(self._mine, "process", None)
        if process is None:
            with self._lock:
                if self._ended:
                    raise EOFError
                process = _started()
                self._all.add(process)
            self._mine.process = process
            _send(process.stdin, self._work)
        return process

    def _gone(self) -> None:
        process: subprocess.Popen[bytes] | None = getattr(self._mine, "process", None)
        self._mine.process = None
        if process is not None:
            _end(process)
            with self._lock:
                self._all.discard(process)

    def end(self) -> None:
        """Ends all processes at once; they leave nothing half-done."""
        self._over.set()
        with self._lock:
            self._ended = True
            for process in self._all:
                process.kill()
            for process in self._all:
                _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            with suppress(OSError):
                stream.close()


def _started() -> subprocess.Popen[bytes]:
    # The packages are found where this process finds them, and its threads are kept to one.
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(path or os.curdir for path in sys.path))
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        environment.setdefault(name, "1")
    command = [sys.executable, "-m", "frictionlab.fleet.engines.process"]
    try:
        return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
    except OSError as error:
        raise Failure(f"no process could be started: {error}") from None


def _send(stream: Any, what: object) -> None:
    pickle.dump(what, stream)
    stream.flush()


def _cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
