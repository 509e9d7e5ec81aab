"""Runs an experiment through the action of the node `experiment_runner` and waits for its end.

    python -m friction_analysis.experiment position-tracking --model lugre --set quick=true

From a program:

    with Runner() as runner:
        result = runner.run("position-tracking", models=["lugre"], settings={"quick": "true"})
        print(result.bag_path, result.figures)

Needs rclpy and the package friction_msgs.
"""

from __future__ import annotations

import argparse
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from types import TracebackType
from typing import Any

import rclpy
from friction_msgs.action import RunExperiment
from friction_msgs.msg import Setting
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor

ACTION = "/experiment_runner/run_experiment"


class ExperimentError(Exception):
    """The experiment was refused, failed, or nobody answers; the text says why."""


class Runner:
    """A client of the experiment runner. `wait` is how long to look for it [s]."""

    def __init__(self, action: str = ACTION, wait: float = 10.0) -> None:
        self._context = rclpy.Context()
        rclpy.init(context=self._context)
        self._node = rclpy.create_node("friction_analysis", context=self._context)
        self._client = ActionClient(self._node, RunExperiment, action)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()
        if not self._client.wait_for_server(timeout_sec=wait):
            self.close()
            raise ExperimentError(
                f"nobody offers {action}: start `frictionlab serve` or `experiment_runner` on the same ROS_DOMAIN_ID"
            )

    def __enter__(self) -> Runner:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Leaves the network."""
        # In this order: nothing is destroyed that the thread still uses.
        self._executor.shutdown()
        self._thread.join()
        self._client.destroy()
        self._node.destroy_node()
        self._context.try_shutdown()
        self._context.destroy()

    def run(
        self,
        experiment: str,
        models: Sequence[str] = (),
        repetitions: int = 0,
        settings: Mapping[str, str] | None = None,
        folder: str = "",
        preempt: bool = False,
        progress: Callable[[Any], None] | None = None,
    ) -> RunExperiment.Result:
        """Runs an experiment to its end and returns its result.

        `settings` are options of `frictionlab run` by name; `progress` is called with each feedback, a few times a second. Ctrl-C cancels the
        experiment and still returns what came of it.

        Raises ExperimentError if it is refused or fails.
        """
        goal = RunExperiment.Goal(
            experiment=experiment,
            models=list(models),
            repetitions=repetitions,
            overrides=[Setting(name=name, value=value) for name, value in (settings or {}).items()],
            output_folder=folder,
            preempt=preempt,
        )
        heard = None if progress is None else lambda message: progress(message.feedback)
        handle = self._wait(self._client.send_goal_async(goal, feedback_callback=heard))
        if not handle.accepted:
            raise ExperimentError(f"{experiment} was rejected")
        answer = handle.get_result_async()
        try:
            result = self._wait(answer).result
        except KeyboardInterrupt:
            self._wait(handle.cancel_goal_async())
            result = self._wait(answer).result
        if result.outcome in (RunExperiment.Result.SUCCEEDED, RunExperiment.Result.CANCELED):
            return result
        raise ExperimentError(result.message)

    @staticmethod
    def _wait(future: Any) -> Any:
        done = threading.Event()
        future.add_done_callback(lambda _: done.set())
        # In slices, so that ctrl-C gets through.
        while not done.wait(0.1):
            pass
        return future.result()


def setting(text: str) -> tuple[str, str]:
    """Reads NAME=VALUE; NAME alone is a switch."""
    name, _, value = text.partition("=")
    if not name:
        raise argparse.ArgumentTypeError(f"expected NAME=VALUE, as in seed=3, but {text!r} came")
    return name, value


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(description="Run an experiment through ROS 2 and wait for it.")
    parser.add_argument("experiment", help="its name, as list_experiments tells it")
    parser.add_argument("--model", action="append", default=[], help="a model that compensates; may be repeated")
    parser.add_argument("--repetitions", type=int, default=0, help="0 for the experiment's own number")
    parser.add_argument("--set", action="append", default=[], type=setting, metavar="NAME=VALUE", help="an option")
    parser.add_argument("--folder", default="", help="output folder, new or empty")
    parser.add_argument("--preempt", action="store_true", help="end another experiment that runs")
    options = parser.parse_args(arguments)

    def tell(feedback: Any) -> None:
        print(f"\r{100 * feedback.progress:5.1f} %  {feedback.stage:<40}", end="", file=sys.stderr, flush=True)

    try:
        with Runner() as runner:
            result = runner.run(
                options.experiment,
                options.model,
                options.repetitions,
                dict(options.set),
                options.folder,
                options.preempt,
                tell,
            )
    except ExperimentError as error:
        print(f"\nerror: {error}", file=sys.stderr)
        return 2
    print(file=sys.stderr)
    print(result.message)
    for figure in result.figures:
        print(f"{figure.task:<20} {figure.row:<24} {figure.name:<22} {figure.value:12.5g} {figure.unit}")
    for parameter in result.parameters:
        error = f" ± {parameter.standard_error:.1g}" if parameter.standard_error == parameter.standard_error else ""
        print(f"{parameter.model} {parameter.name:<8} {parameter.value:.5g}{error} {parameter.unit}")
    return 0 if result.success else 130


if __name__ == "__main__":
    sys.exit(main())
