"""Print what fleets are judged with, as tables.

  python -m frictionlab.fleet.trial drift
  python -m frictionlab.fleet.trial engines --engine local,ray --recordings 400
  python -m frictionlab.fleet.trial driver --recordings 100000

`drift` makes fleets of 500 joints of which 5 % degrade, and tells how soon that is known and how many joints are named
wrongly. `engines` makes recordings and tells what one costs on each engine with one and two workers; `driver` tells
what it costs the driver alone.
"""

from __future__ import annotations

import sys

from friction_analysis.console import command, conclude

from . import drift, engines


def main(arguments: list[str] | None = None) -> int:
    """Prints the table that is asked for."""
    parser = command("python -m frictionlab.fleet.trial", __doc__ or "")
    parser.add_argument("what", choices=("drift", "engines", "driver"))
    parser.add_argument("--seeds", type=int, default=3, metavar="N", help="fleets for each line of `drift` (default: 3)")
    parser.add_argument("--engine", default="local", metavar="NAMES", help="engines, with commas (default: local)")
    parser.add_argument("--recordings", type=int, default=400, metavar="N", help="recordings for `engines` (default: 400)")
    parser.add_argument("--points", type=int, default=40, metavar="N", help="points a direction of each of them (default: 40)")
    parser.add_argument("--model", default="stribeck", metavar="NAME", help="model for `engines` (default: stribeck)")
    given = parser.parse_args(arguments)

    def work() -> int:
        if given.what == "drift":
            print(drift.table(given.seeds))
        elif given.what == "driver":
            print(engines.driver(given.recordings))
        else:
            print(engines.table(given.engine.split(","), given.recordings, given.points, model=given.model))
        return 0

    return conclude(work)


if __name__ == "__main__":
    sys.exit(main())
