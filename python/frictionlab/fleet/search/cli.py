"""Do one long computation in shares: on all cores of this machine, or on a Ray cluster.

  friction-search --out draws -- frictionlab monte-carlo --draws 100000
  friction-search --out matrix --engine ray --shares 40 -- frictionlab truth-matrix --seeds 100
  friction-search --out trial --shares 100 -- frictionlab commission --trial 1000 --seed 7
  friction-search --out seeds --shares 10 -- cargo xtask strangers --machines 400

Behind -- stands the command as you would give it alone. It is cut by its option --part and joined by --join, so the
result in --out/result is the same, bit for bit, whatever the engine and the number of shares. What each share found is
kept in --out/shares: give the same command again after it was stopped and it goes on. A share that fails is reported; the
result is of the others. On a cluster the program must be installed on each machine.

Exit codes: 0 done, 1 a share failed, 2 wrong input, 130 interrupted.
"""

from __future__ import annotations

import sys

from friction_analysis.console import command, conclude, positive

from ...errors import BadInput, FrictionlabError
from ..cli import engines, whole
from ..progress import Shown
from .run import DAY, SHARES, search, told


def main(arguments: list[str] | None = None) -> int:
    """The command `friction-search`."""
    parser = command("friction-search", __doc__ or "")
    parser.add_argument("--out", required=True, metavar="FOLDER", help="folder of shares and result")
    parser.add_argument("--shares", type=whole, metavar="N", help=f"number of shares (default: {SHARES}, or as before)")
    engines(parser)
    parser.add_argument(
        "--longest", type=positive, default=DAY, metavar="S", help="a share is given up after so long (default: a day)"
    )
    parser.add_argument("--quiet", action="store_true", help="say nothing until the end")
    parser.add_argument("command", nargs="+", metavar="COMMAND", help="program and options, behind --")
    given = parser.parse_args(arguments)

    def work() -> int:
        shown = Shown()
        try:
            found = search(
                given.command,
                given.out,
                shares=given.shares,
                engine=given.engine,
                workers=given.workers,
                ray_address=given.ray_address,
                longest_s=given.longest,
                on_progress=None if given.quiet else shown,
            )
        except FrictionlabError as error:
            shown.end()
            print(f"error: {error}", file=sys.stderr)
            return 2 if isinstance(error, BadInput) else 1
        finally:
            shown.end()
        print(found.text, end="")
        for why in found.failed[:20]:
            print(why, file=sys.stderr)
        if found.failed:
            print(f"error: {told(found)}", file=sys.stderr)
        return 1 if found.failed else 0

    return conclude(work)


if __name__ == "__main__":
    sys.exit(main())
