"""Kills a random process of the loop at a random moment, again and again. usage: killed_session.py FOLDER ROUNDS SEED"""

import json
import random
import signal
import sys

from rig_bench import PROGRAMS, RIG, Bench
from ros_calls import caller


def main() -> None:
    folder, rounds, seed = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    dice = random.Random(seed)
    report = []
    with caller(fast=True) as ros, Bench(ros, folder) as bench:
        bench.velocity = 1.5
        bench.start(*PROGRAMS)
        assert bench.moves(1.5, 30), "the loop does not close"
        for _ in range(rounds):
            victim = dice.choice(PROGRAMS)
            ros.spin(0.2 + dice.random() * 0.5)
            bench.forget()
            ros.spin(0.1)
            bench.end(victim, signal.SIGKILL)
            ros.spin(0.8)
            told = {"victim": victim}
            if victim == "controller":
                told["last_voltage"] = bench.last_voltage() - bench.last_command()
                told["faulted"] = bench.measured[-1].fault
            told["highest"] = max((abs(m.voltage_applied) for m in bench.measured), default=0.0)
            bench.start(victim)
            if victim == "controller":
                ros.until(lambda: bench.last_command() > bench.last_voltage() + 0.6, 10)
                ros.until(lambda: ros.state(RIG) == "inactive", 5)
                told["cleared"] = bench.clear_and_activate()
            told["moves_again"] = bench.moves(1.5, 20)
            report.append(told)
        print(json.dumps({"rounds": report, "exit": [list(bench.end(name)[:2]) for name in PROGRAMS]}))


if __name__ == "__main__":
    main()
