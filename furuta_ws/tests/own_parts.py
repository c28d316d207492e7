"""Functions as parts of a loop, for tests."""

from dataclasses import dataclass
from math import nan
from typing import Any

import furuta
from furuta_model.elementary import exp


def stribeck(v: float, p: Any) -> float:
    """The arithmetic of the law of that name."""
    ratio = v / p.stribeck_velocity
    if ratio * ratio > 50.0:
        return p.alpha0
    return p.alpha0 + p.alpha1 * exp(-ratio * ratio)


def breakaway(p: Any) -> float:
    """That of stiction."""
    return p.alpha0 + p.alpha1


LUGRE = furuta.Law("own_lugre", stribeck, breakaway, bristle=True)


@dataclass
class Count:
    """Samples so far and the sum of the arm's speed [rad/s]."""

    samples: int = 0
    speed: float = 0.0


def counting(memory: Count, x: Any, p: Any) -> float:
    """Depends on everything that it gets."""
    memory.samples += 1
    memory.speed += x[1]
    return p.friction.alpha0 * memory.speed / memory.samples + p.sample_time * x[3]


def array_counting(memory: Any, x: Any, p: Any) -> float:
    """The same with an array as memory."""
    memory[0] += 1
    memory[1] += x[1]
    return p.friction.alpha0 * memory[1] / memory[0] + p.sample_time * x[3]


def impossible(memory: Any, x: Any, p: Any) -> float:
    """No F̂ that could be sent."""
    return 1e9 if x[0] > 0.0 else nan


def feedback(memory: Any, x: Any, friction: float, p: Any) -> float:
    """U = −Lx + F̂."""
    return -(p.l1 * x[0] + p.l2 * x[1] + p.l3 * x[2] + p.l4 * x[3]) + friction


def differences(memory: Any, x: Any, measurement: Any, p: Any) -> None:
    """Filtered differences of θ."""
    x[3] += 0.2 * ((measurement[2] - x[2]) / p.sample_time - x[3])
    x[0], x[1], x[2], x[4] = measurement[0], measurement[1], measurement[2], nan


# A module that says when it is loaded.
EVIL = """
import sys
sys.loaded_evil = True
def f(memory, x, friction, p):
    return 0.25
"""
