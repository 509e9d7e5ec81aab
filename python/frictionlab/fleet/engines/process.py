"""A process of the local engine: it reads settings, then tasks, and writes an outcome for each."""

from __future__ import annotations

import os
import pickle
import signal
import sys

from ..settings import Settings
from ..work import Task, outcome


def main() -> None:
    """Works until nobody asks any longer."""
    # Ctrl-C in a terminal is for the process that asked; it ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    asked = sys.stdin.buffer
    # What libraries print must not stand between the outcomes.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    try:
        settings: Settings = pickle.load(asked)
        while True:
            task: Task = pickle.load(asked)
            pickle.dump(outcome(settings, task), answers)
            answers.flush()
    except (EOFError, BrokenPipeError):
        return


if __name__ == "__main__":
    main()
