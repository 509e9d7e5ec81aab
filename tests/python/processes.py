"""Starts and ends the laboratory's programs."""

import os
import signal
import subprocess
import time


def there():
    """What stands before a command that runs on the programs' machine, if that is another than the script's. It becomes the command: signals reach it."""
    machine = os.environ.get("PROGRAMS_MACHINE")
    return ["nsenter", "-t", machine, "-n"] if machine else []


class Processes:
    """The programs of one test, ended with it."""

    def __init__(self, folder):
        self.folder = folder
        self.running = []

    def start(self, program, *ros_arguments):
        return self.run(os.path.join(self.folder, program), "--ros-args", *ros_arguments)

    def run(self, *command):
        """Starts one by its whole command."""
        process = subprocess.Popen([*there(), *command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.running.append(process)
        return process

    def end(self, process, how=signal.SIGINT):
        """Ends one; returns its exit code, the seconds it took, and what it said."""
        started = time.monotonic()
        process.send_signal(how)
        try:
            _, said = process.communicate(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            _, said = process.communicate()
        self.running.remove(process)
        return process.returncode, time.monotonic() - started, said

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in list(self.running):
            process.kill()
            process.communicate()
