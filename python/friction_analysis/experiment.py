"""Runs an experiment through the action /experiment_runner/run_experiment, shows how it goes and waits for its end.

  friction-run --list                                         the experiments, what each does and takes
  friction-run position-tracking --model lugre --model proposed --repetitions 3
  friction-run characterise --set quick --set seed=7 --out monday --json monday.json

Ctrl-C, or SIGTERM, cancels the experiment, waits until the rig stands and tells what was kept; a second one leaves at once.
Exit code 0: it succeeded; 1: it failed; 2: it was refused, or nobody answers; 130: it was cancelled, here or by somebody else.
The other side is `frictionlab serve` or the node experiment_runner. Needs rclpy and friction_msgs.
"""

from __future__ import annotations

import json
import math
import signal
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import Any

from friction_analysis.console import command, conclude, positive
from friction_analysis.ros import RosError, SpinningNode, load, surroundings
from friction_analysis.topics import topic_name

_SETTLING = 0.2
"""Time from finding an experiment runner to asking it [s]."""


class Outcome(IntEnum):
    """How an experiment ended, as in friction_msgs/action/RunExperiment."""

    SUCCEEDED = 0
    CANCELED = 1
    BUSY = 2
    BAD_REQUEST = 3
    FAILED = 4


@dataclass(frozen=True)
class Request:
    """What is asked of the experiment runner; what is left empty is the experiment's own choice."""

    experiment: str
    """Name, as `friction-run --list` tells it."""
    models: Sequence[str] = ()
    """Models that compensate friction."""
    repetitions: int = 0
    """Repetitions of everything."""
    overrides: dict[str, str] = field(default_factory=dict)
    """Options of `frictionlab run` by name, without dashes."""
    output_folder: str = ""
    """Folder for the results, on the machine of the experiment runner."""
    preempt: bool = False
    """End the experiment that runs, if one does."""


@dataclass(frozen=True)
class Progress:
    """One feedback of a running experiment."""

    stage: str
    repetition: int
    """From 1; 0 where the stage has none."""
    progress: float
    """0 to 1."""
    remaining: float
    """Expected time to the end [s]; not a number while unknown."""


@dataclass(frozen=True)
class Result:
    """How it ended; paths are on the machine of the experiment runner."""

    outcome: Outcome
    message: str
    run_id: str
    folder: str
    bag_path: str
    report: str
    parameters_file: str
    parameters: list[dict[str, Any]] = field(repr=False)
    """What was identified: model, name, unit, value, standard_error, low, high, identified, explanation."""
    figures: list[dict[str, Any]] = field(repr=False)
    """The table of figures: task, row, name, unit, value, deviation."""

    @property
    def success(self) -> bool:
        """It came to its end."""
        return self.outcome is Outcome.SUCCEEDED


def run_experiment(
    request: Request,
    on_progress: Callable[[Progress], None] | None = None,
    namespace: str = "",
    patience: float = 15.0,
) -> Result:
    """Runs an experiment and waits for its end, however long that takes.

    `on_progress` is called from another thread. A KeyboardInterrupt cancels the experiment and returns its result when the
    rig stands; a second one passes through. `patience` [s]: longest wait for the action to be there and for its answers.
    Raises `RosError` if nobody answers or ROS is missing.
    """
    name = topic_name("experiment_runner/run_experiment", namespace)
    with SpinningNode("friction_run") as ros:
        client = load("rclpy.action").ActionClient(ros.node, load("friction_msgs.action").RunExperiment, name)
        try:
            _offered(client.server_is_ready, name, patience)
            return _follow(client, request, on_progress, patience)
        finally:
            client.destroy()


def list_experiments(namespace: str = "", patience: float = 15.0) -> list[dict[str, Any]]:
    """The experiments that there are: name, description, duration and quick_duration [s], parameters. Raises `RosError`."""
    name = topic_name("experiment_runner/list_experiments", namespace)
    with SpinningNode("friction_run") as ros:
        kind = load("friction_msgs.srv").ListExperiments
        client = ros.node.create_client(kind, name)
        _offered(client.service_is_ready, name, patience)
        answer = _wait(client.call_async(kind.Request()), patience, f"no answer from {name}")
        return [_plain(experiment) for experiment in answer.experiments]


def _follow(client: Any, request: Request, on_progress: Callable[[Progress], None] | None, patience: float) -> Result:
    def heard(message: Any) -> None:
        if on_progress is not None:
            told = message.feedback
            on_progress(Progress(told.stage, told.repetition, told.progress, told.remaining))

    sending = client.send_goal_async(_goal(request), feedback_callback=heard)
    unanswered = "no answer to the experiment's goal"
    interrupted = False
    try:
        handle = _wait(sending, patience, unanswered)
    except KeyboardInterrupt:
        # The goal is on its way: only with its handle can it be cancelled.
        interrupted = True
        handle = _wait(sending, patience, unanswered)
    if not handle.accepted:
        raise RosError(f"the experiment runner did not take {request.experiment}; its log says why")
    ending = handle.get_result_async()
    try:
        if interrupted:
            raise KeyboardInterrupt
        answer = _wait(ending)
    except KeyboardInterrupt:
        handle.cancel_goal_async()
        # The rig stops within its watchdog's period; writing what was measured takes longer.
        answer = _wait(ending, max(patience, 60.0), "the experiment was cancelled, but its end was not told")
    return _result(answer.result)


def _goal(request: Request) -> Any:
    setting = load("friction_msgs.msg").Setting
    return load("friction_msgs.action").RunExperiment.Goal(
        experiment=request.experiment,
        models=list(request.models),
        repetitions=request.repetitions,
        overrides=[setting(name=name, value=value) for name, value in request.overrides.items()],
        output_folder=request.output_folder,
        preempt=request.preempt,
    )


def _result(message: Any) -> Result:
    try:
        outcome = Outcome(message.outcome)
    except ValueError:
        raise RosError(f"the experiment runner answered with outcome {message.outcome}, which is not known here") from None
    texts = ("message", "run_id", "folder", "bag_path", "report", "parameters_file")
    return Result(
        outcome=outcome,
        parameters=[_plain(parameter) for parameter in message.parameters],
        figures=[_plain(figure) for figure in message.figures],
        **{name: getattr(message, name) for name in texts},
    )


def _plain(value: Any) -> Any:
    """A message as dictionaries and lists; what is not a number becomes None."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: _plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value


def _offered(ready: Callable[[], bool], name: str, patience: float) -> None:
    """Waits in small steps, so that ctrl-C is heard."""
    end = time.monotonic() + patience
    while not ready():
        if time.monotonic() > end:
            raise RosError(f"nobody offers {name}; start `frictionlab serve` or the node experiment_runner. {surroundings()}")
        time.sleep(0.05)
    # The other side may find this client a moment later than it is found, and what it cannot place is sent again only by
    # Fast DDS's heartbeat, every 3 s.
    time.sleep(_SETTLING)


def _wait(future: Any, seconds: float = math.inf, complaint: str = "") -> Any:
    """The future's result, waited for in small steps, so that ctrl-C is heard."""
    end = time.monotonic() + seconds
    while not future.done():
        if time.monotonic() > end:
            raise RosError(f"{complaint} within {seconds:g} s")
        # An interrupt inside a condition variable can come out as another exception; sleeping passes it on as it is.
        time.sleep(0.05)
    return future.result()


class _ProgressLine:
    """Progress on standard error: one line that changes on a terminal, a line for each stage elsewhere."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._stage = ""

    def __call__(self, told: Progress) -> None:
        repetition = f", repetition {told.repetition}" if told.repetition else ""
        remaining = f", about {told.remaining:.0f} s to go" if math.isfinite(told.remaining) else ""
        text = f"{100.0 * told.progress:3.0f} %  {told.stage}{repetition}{remaining}"
        if self._terminal:
            print(f"\r{text:<78.78}", end="", file=sys.stderr, flush=True)
        elif told.stage != self._stage:
            print(text, file=sys.stderr, flush=True)
        self._stage = told.stage

    def end(self) -> None:
        if self._terminal and self._stage:
            print(file=sys.stderr)


def _tell(result: Result) -> None:
    print(f"{result.outcome.name.lower()}: {result.message}", file=sys.stdout if result.success else sys.stderr)
    for figure in result.figures:
        deviation = f" ± {figure['deviation']:.2g}" if figure["deviation"] is not None else ""
        value = "-" if figure["value"] is None else f"{figure['value']:.4g}"
        print(f"  {figure['task']} | {figure['row']} | {figure['name']} | {value}{deviation} {figure['unit']}".rstrip())
    for name in ("folder", "bag_path", "report", "parameters_file"):
        if value := getattr(result, name):
            print(f"  {name}: {value}")


def _list(experiments: list[dict[str, Any]]) -> None:
    for experiment in experiments:
        seconds = experiment["duration"]
        duration = "" if seconds is None else f" ({seconds:.0f} s in real time)"
        print(f"{experiment['name']}{duration}\n    {experiment['description']}")
    if experiments:
        print("options, for --set:")
        for parameter in experiments[0]["parameters"]:
            default = f" [default: {parameter['default_value']}]" if parameter["default_value"] else ""
            print(f"  {parameter['name']}: {parameter['description']}{default}")


def main(arguments: list[str] | None = None) -> int:
    """The command `friction-run`."""
    parser = command("friction-run", __doc__ or "")
    parser.add_argument("experiment", nargs="?", metavar="EXPERIMENT", help="name of the experiment")
    parser.add_argument("--list", action="store_true", help="tell which experiments there are and end")
    parser.add_argument(
        "--model", action="append", default=[], metavar="NAME", help="model that compensates; may come several times"
    )
    parser.add_argument(
        "--repetitions", type=int, default=0, metavar="N", help="repetitions of everything (default: the experiment's)"
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="option of the experiment; NAME alone is a switch; may come several times",
    )
    parser.add_argument(
        "--out", default="", metavar="DIR", help="folder of the results, in the experiment runner's folder of runs"
    )
    parser.add_argument("--preempt", action="store_true", help="end the experiment that runs, if one does")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the result there as JSON")
    parser.add_argument("--namespace", default="", metavar="NS", help="namespace of the experiment runner (default: none)")
    parser.add_argument("--wait", type=positive, default=15.0, metavar="S", help="longest wait for an answer [s] (default: 15)")
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    given = parser.parse_args(arguments)
    if given.list == (given.experiment is not None):
        parser.error("the name of an experiment was expected, or --list alone")
    overrides = {}
    for text in given.set:
        name, equals, value = text.partition("=")
        if not name:
            parser.error(f"--set: NAME=VALUE was expected, as in seed=7, but {text!r} came")
        overrides[name] = value if equals else "true"
    if not 0 <= given.repetitions < 2**32:
        parser.error(f"--repetitions: a whole number from 0 was expected, but {given.repetitions} came")

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    # Whoever ends this program by a signal must not leave a rig behind that nobody watches.
    signal.signal(signal.SIGTERM, interrupt)

    def work() -> int:
        if given.list:
            _list(list_experiments(given.namespace, given.wait))
            return 0
        request = Request(given.experiment, given.model, given.repetitions, overrides, given.out, given.preempt)
        line = _ProgressLine()
        result = run_experiment(request, None if given.quiet else line, given.namespace, given.wait)
        line.end()
        _tell(result)
        if given.json is not None:
            told = {**asdict(result), "outcome": result.outcome.name}
            given.json.write_text(json.dumps(told, indent=1), encoding="utf-8")
        return exit_code(result)

    return conclude(work)


def exit_code(result: Result) -> int:
    """Exit code that tells of the result."""
    return {
        Outcome.SUCCEEDED: 0,
        Outcome.FAILED: 1,
        Outcome.BUSY: 2,
        Outcome.BAD_REQUEST: 2,
        Outcome.CANCELED: 130,
    }[result.outcome]


if __name__ == "__main__":
    sys.exit(main())
