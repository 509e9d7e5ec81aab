"""What tasks are done on: the cores of this machine, or a Ray cluster."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from typing import Any, Protocol, TypeVar

from ...errors import BadInput

# Times that a task is tried whose process ended without a word.
TRIES = 3

T = TypeVar("T")
T_contra = TypeVar("T_contra", contravariant=True)
R = TypeVar("R")
R_co = TypeVar("R_co", covariant=True)


class Work(Protocol[T_contra, R_co]):
    """What is done with each task. It is sent to each worker once, tasks and outcomes one by one."""

    @property
    def longest_s(self) -> float:
        """A task takes no longer: `do` itself sees to that; a process that goes on is ended some time later."""
        ...

    def do(self, task: T_contra) -> R_co:
        """Does it. Whatever is wrong with it is told in the outcome."""
        ...

    def failed(self, task: T_contra, why: str) -> R_co:
        """The outcome of a task that the engine could not have done."""
        ...


class Engine(Protocol[T_contra, R_co]):
    """Does tasks side by side."""

    # Processes side by side.
    workers: int

    def outcomes(self, tasks: Iterable[T_contra]) -> Generator[R_co, None, None]:
        """What comes of each task, in whichever order, each once.

        No more tasks are taken than are worked on and wait for it, so that memory is bounded. Closing it ends all
        that runs.
        """
        ...


def engine(name: str, work: Work[Any, R], workers: int | None = None, address: str | None = None) -> Engine[Any, R]:
    """The engine of that name."""
    if workers is not None and workers < 1:
        raise BadInput(f"there must be a worker at least, but {workers} were asked for")
    if name == "local":
        from .local import Local

        return Local(work, workers)
    if name == "ray":
        from .cluster import Cluster

        return Cluster(work, workers, address)
    raise BadInput(f"expected the engine `local` or `ray`, but got `{name}`")


def died(tries: int) -> str:
    """What is said of a task that ends each process that does it."""
    times = "once" if tries == 1 else f"{tries} times"
    return f"the process that worked on it ended {times} without a word; it may need more memory than there is"
