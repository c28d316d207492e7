"""State feedback with friction compensation, eqs. (6) to (8).

The sign convention of the whole workspace: (1) has u − F on its right side, with F > 0 when
friction opposes positive arm speed. An estimate F̂ of that F is therefore *added*:

    u = −Lx + F̂

(the scan of the paper prints a minus in (8), which would double the friction).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from furuta_control.excitation import NONE, TURN, Excitation, excitation, shape, within_limits
from furuta_control.parameters import ControllerParameters
from furuta_model.compiled import inlined
from furuta_model.linear import place_poles
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# The controller's memory: whether it holds the pendulum (1) or has given up (0), then the phase
# of its excitation.
PHASE = 1
MEMORY = PHASE + 1


class StateFeedback(NamedTuple):
    """What :func:`control` computes with."""

    l1: float
    l2: float
    l3: float
    l4: float
    voltage_limit: float
    fall_angle: float
    catch_angle: float
    enabled: bool
    excitation: Excitation


def state_feedback(p: ControllerParameters) -> StateFeedback:
    """The gain given explicitly, or else by pole placement on the nominal model, eq. (7)."""
    gain: Iterable[float] = p.gain or place_poles(p.model, p.poles)
    l1, l2, l3, l4 = (float(each) for each in gain)
    limits = (p.voltage_limit, p.fall_angle, p.catch_angle)
    excited = excitation(p.excitation, p.sample_time)
    return StateFeedback(l1, l2, l3, l4, *limits, p.enabled, excited)


@inlined
def control(memory: np.ndarray, x: np.ndarray, friction: float, p: StateFeedback) -> float:
    """Command u [V] for the state estimate ``x`` (4,) and friction estimate [V]."""
    tilt = 0.0 if p.excitation.open_loop else abs(x[THETA])
    if tilt > p.fall_angle:
        memory[0] = 0.0
    elif tilt <= p.catch_angle:
        memory[0] = 1.0
    if memory[0] == 0.0 or not p.enabled:
        return 0.0
    u = 0.0
    if not p.excitation.open_loop:
        u = friction - p.l1 * x[PHI] - p.l2 * x[PHI_DOT] - p.l3 * x[THETA] - p.l4 * x[THETA_DOT]
    if p.excitation.kind != NONE and within_limits(x[PHI], x[PHI_DOT], x[THETA], p.excitation):
        u += p.excitation.amplitude * shape(p.excitation.kind, memory[PHASE])
        memory[PHASE] = (memory[PHASE] + p.excitation.step) % TURN
    return min(max(u, -p.voltage_limit), p.voltage_limit)
