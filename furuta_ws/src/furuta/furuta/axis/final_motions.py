"""Which final motions random loops have."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from furuta.axis.axis import servo_cycle
from furuta.axis.random_axes import random_axis
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta_model.friction.laws import friction_law
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles, place_poles
from furuta_model.pendulum import FurutaPendulum

Rows = list[dict[str, Any]]
HUNTING = ("limit_cycle", "irregular")
# Ranges of the pole pairs (ω₁, ζ₁, ω₂, ζ₂) [rad/s] of random state feedbacks.
SLOWEST, FASTEST = (4.0, 0.4, 3.0, 0.4), (12.0, 1.1, 10.0, 1.1)
PENDULUM_LAWS = ("coulomb", "stiction", "stribeck", "lugre")


def coulomb_axes(loops: int, seed: int) -> tuple[Rows, bool]:
    """Random PID loops under Coulomb friction: whether none of them hunts."""
    kinds = _axis_kinds(loops, seed, "coulomb")
    return _rows(kinds), not any(kinds[kind] for kind in HUNTING)


def static_axes(loops: int, seed: int) -> tuple[Rows, bool]:
    """Random PID loops with static friction above Coulomb's: whether all of them hunt."""
    kinds = _axis_kinds(loops, seed, "stiction")
    return _rows(kinds), sum(kinds[kind] for kind in HUNTING) == loops


def _axis_kinds(loops: int, seed: int, law: str) -> Counter[str]:
    random = np.random.default_rng(seed)
    return Counter(servo_cycle(*random_axis(random, law)).kind for _ in range(loops))


def _rows(kinds: Counter[str]) -> Rows:
    return [{"kind": kind, "loops": number} for kind, number in sorted(kinds.items())]


def pendulum_feedbacks(loops: int, seed: int) -> tuple[Rows, bool]:
    """Random state feedbacks of the paper's pendulum: whether none ends at a stable rest."""
    random, kinds = np.random.default_rng(seed), Counter[str]()
    body = FurutaPendulum()
    for number in range(loops):
        poles = DesiredPoles(*(float(value) for value in random.uniform(SLOWEST, FASTEST)))
        law = friction_law(PENDULUM_LAWS[number % len(PENDULUM_LAWS)], Friction())
        cycle = limit_cycle(IdealLoop(body, law, *(-place_poles(body, poles))))
        kinds["stable rest" if cycle.kind == "rest" and cycle.stable else cycle.kind] += 1
    return _rows(kinds), not kinds["stable rest"]
