"""A process of the local engine: it reads the work, then tasks, and writes an outcome for each."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import time
from typing import Any

from . import Work


# How often a process looks whether the one that asked is still there [s].
LOOK = 1.0


def _ends_with(asker: int) -> None:
    """Ends this process when the one that started it is gone: a task may take hours."""
    while os.getppid() == asker:
        time.sleep(LOOK)
    os._exit(1)


def main() -> None:
    """Works until nobody asks any longer."""
    threading.Thread(target=_ends_with, args=(os.getppid(),), daemon=True).start()
    # Ctrl-C in a terminal is for the process that asked; it ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    asked = sys.stdin.buffer
    # What libraries print must not stand between the outcomes.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    try:
        work: Work[Any, Any] = pickle.load(asked)
        while True:
            pickle.dump(work.do(pickle.load(asked)), answers)
            answers.flush()
    except (EOFError, BrokenPipeError):
        return


if __name__ == "__main__":
    main()
