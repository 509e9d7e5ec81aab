"""Prints, as JSON, the commands that a launch file of this project would start with `executables:=path`.

usage: launch_commands.py FILE [NAME:=VALUE ...]
"""

import json
import sys
from pathlib import Path

from launch_stub import Shutdown, launch


def main() -> None:
    file, *given = sys.argv[1:]
    context = launch(Path(file), executables="path", **dict(text.split(":=", 1) for text in given))
    print(json.dumps([{"command": process.cmd, "ends_all": isinstance(process.on_exit, Shutdown)} for process in context.started]))


if __name__ == "__main__":
    main()
