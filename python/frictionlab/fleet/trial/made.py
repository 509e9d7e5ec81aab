"""Fleets that are made: recordings of steady sliding, and series of estimates, with a known truth."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np

from ..._given import Floats


@dataclass(frozen=True)
class MadeFleet:
    """Joints of one kind whose friction scatters, depends on the temperature and in some of them grows."""

    joints: int = 500
    recordings: int = 40
    # Share of joints that degrade, from a recording on that is drawn from the middle half.
    degrading: float = 0.05
    # Coulomb friction [N m], how joints and recordings of one joint scatter about it, and its error [relative].
    level: float = 0.1
    between: float = 0.1
    within: float = 0.02
    error: float = 0.01
    # Relative influence of the temperature [1/K].
    temperature: float = -0.003
    # Growth a recording of a degrading joint [relative].
    growth: float = 0.01
    seed: int = 1


@dataclass(frozen=True)
class Joint:
    """The estimates of a made joint in the order of time."""

    values: Floats
    errors: Floats
    temperatures: Floats
    # The first recording of the degraded joint; none where it does not degrade.
    begin: int | None


def joints(fleet: MadeFleet) -> list[Joint]:
    """The series of a made fleet, the same for the same seed."""
    random = np.random.default_rng(fleet.seed)
    n, count = fleet.recordings, round(fleet.degrading * fleet.joints)
    degrade = set(random.permutation(fleet.joints)[:count].tolist())
    found = []
    for number in range(fleet.joints):
        level = fleet.level * (1.0 + fleet.between * random.standard_normal())
        temperatures = 25.0 + 6.0 * np.sin(2 * np.pi * np.arange(n) / 17.0) + 2.0 * random.standard_normal(n)
        errors = fleet.error * level * np.exp(0.3 * random.standard_normal(n))
        begin = int(random.integers(n // 4, 3 * n // 4))
        grown = fleet.growth * np.maximum(np.arange(n) - begin + 1, 0) if number in degrade else np.zeros(n)
        truth = level * (1.0 + fleet.temperature * (temperatures - 25.0) + grown)
        values = truth + fleet.within * level * random.standard_normal(n) + errors * random.standard_normal(n)
        found.append(Joint(values, errors, temperatures, begin if number in degrade else None))
    return found


def recording(seed: int, coulomb: float = 0.1, points: int = 40) -> bytes:
    """A CSV file of steady sliding: Coulomb and viscous friction with noise, the same for the same seed."""
    random = np.random.default_rng(seed)
    v = np.r_[-np.linspace(0.05, 3.0, points), np.linspace(0.05, 3.0, points)]
    torque = coulomb * np.sign(v) + 0.04 * v + 0.002 * random.standard_normal(v.size)
    text = io.StringIO()
    text.write("velocity_rad_s,torque_Nm\n")
    for pair in zip(v, torque, strict=True):
        text.write("{:.9f},{:.9f}\n".format(*pair))
    return text.getvalue().encode()
