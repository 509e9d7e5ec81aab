"""Identify a whole fleet: many recordings in, one Parquet dataset and one page out.

  friction-fleet recordings/ --out fleet --model stribeck
  friction-fleet 's3://bucket/runs/**/*.csv' --out fleet --names '(?P<machine>arm[0-9]+)/(?P<time>[0-9T-]+)'
  friction-fleet --table recordings.csv --out fleet --engine ray

RECORDINGS are folders, files, patterns (quoted, so that the shell leaves them alone) or addresses. A bag is a folder
with its metadata.yaml. A --table has the column `uri`, and where they are known `machine`, `joint`, `time`, `age_h` and
`temperature_c`; --names reads the same out of paths. Without them every recording counts as one machine's, and
nothing is said of change, temperature and age.

In the folder --out: results/*.parquet (a row a recording, joint, model and parameter, with value, standard error,
95 % interval and verdict, or the sentence why there is none), joints.parquet (which joints changed), report.html
(read it first) and fleet.json. A run that was stopped goes on where it was when the same command is given again;
a recording that cannot be used is reported and stops nothing. Credentials of a store come from where its own
tools have them (for S3: AWS_* variables, ~/.aws), never from an option.

Exit codes: 0 done (even if some recordings could not be used; the last line counts them), 2 wrong input, 130
interrupted.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from friction_analysis.console import command, conclude, positive

from ..errors import BadInput, FrictionlabError
from .fleet import read
from .progress import Count, Shown, counted
from .run import run

if TYPE_CHECKING:
    import pandas as pd


def main(arguments: list[str] | None = None) -> int:
    """The command `friction-fleet`."""
    given = _parser().parse_args(arguments)

    def work() -> int:
        try:
            return _run(given)
        except FrictionlabError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2 if isinstance(error, BadInput) else 1

    return conclude(work)


def _parser() -> argparse.ArgumentParser:
    parser = command("friction-fleet", __doc__ or "")
    parser.add_argument("recordings", nargs="*", metavar="RECORDINGS", help="folders, files, patterns or addresses")
    parser.add_argument("--out", required=True, metavar="FOLDER", help="folder or address of the results")
    parser.add_argument("--table", type=Path, metavar="FILE", help="CSV or Parquet table with a recording a row")
    parser.add_argument(
        "--names", metavar="REGEX", help="what paths tell, by the groups machine, joint, time, age_h, temperature_c"
    )
    parser.add_argument(
        "--model", metavar="NAME", help="friction model, or several with commas (default: that of `frictionlab identify`)"
    )
    parser.add_argument("--joint", default="all", metavar="NAME", help="joint within each recording (default: all of them)")
    parser.add_argument(
        "--option",
        action="append",
        default=[],
        type=_option,
        metavar="NAME=VALUE",
        help="any other option of `frictionlab identify`, as torque-source=driving; repeatable",
    )
    engines(parser)
    parser.add_argument(
        "--storage",
        action="append",
        default=[],
        type=_option,
        metavar="NAME=VALUE",
        help="what opens the store, as endpoint_url=http://127.0.0.1:9000; repeatable",
    )
    parser.add_argument(
        "--longest", type=positive, default=600.0, metavar="S", help="a recording is given up after so long (default: 600 s)"
    )
    parser.add_argument(
        "--largest-mb", type=positive, default=4000.0, metavar="MB", help="a larger recording is not read (default: 4000)"
    )
    parser.add_argument(
        "--read-again", action="store_true", help="read known recordings too, and look whether their content is the same"
    )
    parser.add_argument(
        "--false-alarms",
        type=_share,
        default=0.01,
        metavar="SHARE",
        help="share of unchanged joints that are called changed (default: 0.01)",
    )
    parser.add_argument("--page-only", action="store_true", help="write the page of --out anew, and identify nothing")
    parser.add_argument("--quiet", action="store_true", help="say nothing until the end")
    return parser


def engines(parser: argparse.ArgumentParser) -> None:
    """The options that say on what work is done."""
    parser.add_argument(
        "--engine", choices=("local", "ray"), default="local", help="cores of this machine, or a Ray cluster (default: local)"
    )
    parser.add_argument(
        "--workers", type=whole, metavar="N", help="processes side by side (default: all cores, or the cluster's)"
    )
    parser.add_argument(
        "--ray-address", metavar="HOST:PORT", help="the cluster (default: $RAY_ADDRESS, or one of this machine alone)"
    )


def _run(given: argparse.Namespace) -> int:
    storage = dict(given.storage)
    if given.page_only:
        fleet = read(given.out, storage)
    else:
        shown = Shown()
        last: list[Count] = []

        def tell(count: Count) -> None:
            last[:] = [count]
            if not given.quiet:
                shown(count)

        try:
            fleet = run(
                _where(given),
                given.out,
                names=given.names,
                engine=given.engine,
                workers=given.workers,
                ray_address=given.ray_address,
                storage=storage,
                longest_s=given.longest,
                largest_mb=given.largest_mb,
                read_again=given.read_again,
                on_progress=tell,
                **_keywords(given),
            )
        finally:
            shown.end()
    fleet.write_page(given.false_alarms)
    failed = fleet.failed["uri"].nunique()
    changed = fleet.joints(given.false_alarms)
    names = changed[changed["changed"]][["machine", "joint"]].drop_duplicates()
    for machine, joint in names.head(20).itertuples(index=False):
        print(f"changed: {' '.join(filter(None, (machine, joint))) or 'the joint'}")
    through = f"{counted(fleet.about['recordings'], 'recording')}, {failed} not usable, {counted(len(names), 'joint')} changed"
    print(f"{through}: {given.out}/report.html")
    return 0


def _where(given: argparse.Namespace) -> list[str] | pd.DataFrame:
    if bool(given.recordings) == (given.table is not None):
        raise BadInput("expected RECORDINGS or --table FILE, one of the two; --help shows examples")
    if given.table is None:
        places: list[str] = given.recordings
        return places
    import pandas as pd

    try:
        return pd.read_parquet(given.table) if given.table.suffix == ".parquet" else pd.read_csv(given.table)
    except (OSError, ValueError) as error:
        raise BadInput(f"{given.table}: expected a table with the column `uri`: {error}") from None


def _keywords(given: argparse.Namespace) -> dict[str, Any]:
    keywords: dict[str, Any] = {name.replace("-", "_"): value for name, value in given.option}
    keywords["joint"] = given.joint
    if given.model:
        keywords["model"] = given.model
    return keywords


def _option(text: str) -> tuple[str, str]:
    found = re.fullmatch(r"-{0,2}([A-Za-z][\w-]*)=(.+)", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"NAME=VALUE was expected, but {text!r} came")
    return found[1], found[2]


def whole(text: str) -> int:
    """Reads an argument that must be a whole number above zero."""
    if not text.isdecimal() or not 1 <= int(text) <= 100_000:
        raise argparse.ArgumentTypeError(f"a whole number from 1 was expected, but {text!r} came")
    return int(text)


def _share(text: str) -> float:
    value = positive(text)
    if value >= 1.0:
        raise argparse.ArgumentTypeError(f"a share between 0 and 1 was expected, but {text!r} came")
    return value


if __name__ == "__main__":
    sys.exit(main())
