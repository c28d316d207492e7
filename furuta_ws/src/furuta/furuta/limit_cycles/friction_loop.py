r"""Equations of a loop with one friction joint: smooth pieces of motion, and where they end.

The joint slides in one direction (``mode`` ±1) or, under a stick-slip law, sticks (``mode`` 0). A
slide ends at v = 0. Sticking ends when the friction that holds the joint reaches the breakaway
level. Under LuGre the joint never sticks; its slides end at v = 0, where |v| is not smooth.

The state is that of the system, which begins with position and speed of the joint, and at last the
deflection of the bristle. A loop is a named tuple with a ``law`` and with the friction ``held``
from which force and deflection are counted. What differs between loops is a function each:

- ``sliding_rate(y, force, dy, loop)`` and ``stuck_rate(y, dy, loop)``: ẏ without the bristle;
- ``holding_force(y, loop)``: the friction that holds the joint, counted from ``held``;
- ``control(y, loop)``: what drives the joint, to draw it;
- ``rest_distance(y, mode, loop)``: how far ``y`` is from a rest;
- ``unbounded(y, loop)``: whether the motion counts as unbounded;
- ``longest_step(mode, loop)``: of the integration [s].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numba
import numba.extending
import numpy as np

from furuta.limit_cycles import linear_loop, pendulum_loop
from furuta.limit_cycles.linear_loop import LinearLoop
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta_model.compiled import compiled
from furuta_model.friction.laws import breakaway_level, sliding_level
from furuta_model.friction.lugre import deflection_rate, highest_level
from furuta_model.state import PHI_DOT

FrictionLoop = IdealLoop | LinearLoop
BRISTLE = -1  # its place in the state

_LOOPS = {IdealLoop: pendulum_loop, LinearLoop: linear_loop}


def by_type(implementations: Mapping[type, Callable[..., Any]]) -> Callable[..., Any]:
    """Return a function that calls one of several compiled functions, chosen by an argument.

    The type of the last argument, a named tuple, chooses; in compiled code once, on compilation.
    """

    def choose(*arguments: Any) -> Any:
        return implementations[type(arguments[-1])](*arguments)

    def implementation(*arguments: Any) -> Any:
        chosen = implementations[arguments[-1].instance_class]
        return lambda *arguments: chosen(*arguments)  # noqa: PLW0108 - numba needs its code

    config: Any = numba.config
    if not config.DISABLE_JIT:
        numba.extending.overload(choose, strict=False)(implementation)
    return choose


def _of_each(name: str):  # type: ignore[no-untyped-def]
    return by_type({loop: getattr(module, name) for loop, module in _LOOPS.items()})


sliding_rate = _of_each("sliding_rate")
stuck_rate = _of_each("stuck_rate")
holding_force = _of_each("holding_force")
control = _of_each("control")
rest_distance = _of_each("rest_distance")
unbounded = _of_each("unbounded")
longest_step = _of_each("longest_step")


@compiled
def rate(y: np.ndarray, mode: float, loop: FrictionLoop, dy: np.ndarray) -> None:
    """Compute ẏ while the joint slides in direction ``mode`` (±1) or sticks (0)."""
    dy[BRISTLE] = 0.0
    if mode == 0.0:
        stuck_rate(y, dy, loop)
        return
    p = loop.law.parameters
    v = y[PHI_DOT]
    level = sliding_level(v, mode, loop.law)
    if loop.law.bristle:
        z = y[BRISTLE]
        dy[BRISTLE] = deflection_rate(v, mode * v, z + loop.held / p.sigma0, level, p)
        force = p.sigma0 * z + p.sigma1 * dy[BRISTLE]
    else:
        force = mode * level - loop.held
    sliding_rate(y, force, dy, loop)


@compiled
def friction_at(y: np.ndarray, loop: FrictionLoop) -> float:
    """Friction in state ``y``, while the joint slides or sticks."""
    p = loop.law.parameters
    v = y[PHI_DOT]
    if v == 0.0 and not loop.law.bristle:
        return holding_force(y, loop)
    mode = 1.0 if v >= 0.0 else -1.0
    level = sliding_level(v, mode, loop.law)
    if loop.law.bristle:
        z = y[BRISTLE]
        z_dot = deflection_rate(v, abs(v), z, level, p)
        return p.sigma0 * z + p.sigma1 * z_dot + p.viscous * v
    return mode * level + p.viscous * v


@compiled
def before_event(y: np.ndarray, mode: float, loop: FrictionLoop) -> float:
    """Event function: positive during the piece of motion ``mode``, zero at its end."""
    if mode != 0.0:
        return mode * y[PHI_DOT]
    hold = holding_force(y, loop)
    forward = breakaway_level(1.0, loop.law) - loop.held
    backward = breakaway_level(-1.0, loop.law) + loop.held
    return min(forward - hold, backward + hold)


@compiled
def next_mode(y: np.ndarray, mode: float, loop: FrictionLoop) -> float:
    """Mode of the piece of motion that follows an event at ``y``."""
    if loop.law.bristle:
        return -mode
    hold = holding_force(y, loop)
    forward, backward = breakaway_level(1.0, loop.law), breakaway_level(-1.0, loop.law)
    if mode != 0.0 and -backward <= hold <= forward:
        return 0.0
    return 1.0 if hold > 0.5 * (forward - backward) else -1.0


def first_mode(y: np.ndarray, loop: FrictionLoop) -> float:
    """Mode of the first piece of motion from state ``y``."""
    if y[PHI_DOT] != 0.0:
        return float(np.sign(y[PHI_DOT]))
    if not loop.law.bristle:
        return next_mode(y, 1.0, loop)
    dy = np.empty(len(y))
    rate(y, 1.0, loop, dy)
    return 1.0 if dy[PHI_DOT] >= 0.0 else -1.0


def smallest_slide(loop: FrictionLoop) -> float:
    """Smallest motion that is a slide: the full deflection of a bristle, both ways."""
    if not loop.law.bristle:
        return 0.0
    return 2.0 * highest_level(loop.law.parameters) / loop.law.parameters.sigma0
