"""What recordings are identified on: the cores of this machine, or a Ray cluster."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from typing import Protocol

from ...errors import BadInput
from ..settings import Settings
from ..work import Outcome, Task

# Times that a recording is tried whose process ended without a word.
TRIES = 3


class Engine(Protocol):
    """Identifies recordings side by side."""

    # Processes side by side.
    workers: int

    def outcomes(self, tasks: Iterable[Task]) -> Generator[Outcome, None, None]:
        """What comes of each task, in whichever order, each once.

        No more tasks are taken than are worked on and wait for it, so that memory is bounded. Closing it ends all
        that runs.
        """
        ...


def engine(name: str, settings: Settings, workers: int | None = None, address: str | None = None) -> Engine:
    """The engine of that name."""
    if workers is not None and workers < 1:
        raise BadInput(f"there must be a worker at least, but {workers} were asked for")
    if name == "local":
        from .local import Local

        return Local(settings, workers)
    if name == "ray":
        from .cluster import Cluster

        return Cluster(settings, workers, address)
    raise BadInput(f"expected the engine `local` or `ray`, but got `{name}`")


def died(task: Task, tries: int) -> Outcome:
    """What is said of a recording that ends each process that reads it."""
    uri = task.recording.uri
    times = "once" if tries == 1 else f"{tries} times"
    return Outcome(
        uri, error=f"{uri}: the process that identified it ended {times} without a word; it may need more memory than there is"
    )
