"""Runs a program in a folder that is deleted afterwards, and ends it when whoever asked is gone.

A worker may be killed at any moment, and the program that it started would go on for hours. So this process stands
between them: it is told of the end of the worker by the end of its standard input. It imports nothing of the package,
so that it starts at once.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress


def main(command: list[str]) -> int:
    """Runs `command` with ``--out`` in a new folder; its exit code, 128 plus the signal's number after one."""
    # Ctrl-C in a terminal is for the process that asked; it ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with tempfile.TemporaryDirectory(prefix="friction-search-") as folder:
        line = [*command, "--out", os.path.join(folder, "out")]  # noqa: PTH118 - it is to start at once
        try:
            program = subprocess.Popen(line, stdin=subprocess.DEVNULL, start_new_session=True)
        except OSError as error:
            print(f"{command[0]} does not start: {error}", file=sys.stderr)
            return 127

        def watch() -> None:
            while os.read(0, 4096):
                pass
            _end(program)

        threading.Thread(target=watch, daemon=True).start()
        code = program.wait()
    return 128 - code if code < 0 else code


def _end(program: subprocess.Popen[bytes]) -> None:
    """Ends the program with all that it started."""
    with suppress(OSError):
        if hasattr(os, "killpg"):
            os.killpg(program.pid, signal.SIGKILL)
        else:
            program.kill()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
