r"""Catches a pendulum that arrives near upright: when it can be caught, and with which feedback.

Near upright βθ̈ + γφ̈ = δθ. The unstable part of the motion is

.. math::
    z = \dot θ + ωθ + \frac{γ}{β}\dot φ, \qquad \dot z = ω\Bigl(z - \frac{γ}{β}\dot φ\Bigr),
    \qquad ω^2 = δ/β

An arm whose speed is at most V can therefore only stop a |z| below Vγ/β, and needs a travel of
about zβ/(γω). The pendulum is caught within the catch angle if z needs at most :data:`USED_SHARE`
of that speed and :data:`USED_TRAVEL_SHARE` of the travel that is left. The feedback is a
linear-quadratic regulator; its weights are the inverse squares of what the limits allow (Bryson's
rule), that of the command times :data:`EFFORT`. It brings the pendulum to where balancing takes
over.

A costly command makes the gain small: in the limit the regulator only mirrors the unstable pole.
Such a loop tolerates several times the delay, and catches as surely: what can be caught depends on
the arm's speed and travel, not on the gain.
"""

from math import nan, pi, sqrt
from typing import NamedTuple

import numpy as np

from furuta_control.modes.arm_limits import ArmLimits
from furuta_control.modes.mode import ControlledRig, Gain, fed_back
from furuta_model.compiled import inlined
from furuta_model.linear import linearize
from furuta_model.state import PHI, PHI_DOT, THETA, THETA_DOT

# Pendulum angle [rad] within which it is caught, and beyond which it has been missed.
CATCH_ANGLE = 0.5
MISSED_ANGLE = 0.7
# Part of the used travel within which the arm must be.
CATCH_TRAVEL = 0.8
# Shares of the arm's speed, and of the travel left, that catching may need.
USED_SHARE = 0.65
USED_TRAVEL_SHARE = 0.25
# Bryson's weights: deviations [rad], the speed of the pendulum relative to its frequency.
ARM_DEVIATION = 0.5
PENDULUM_DEVIATION = 0.3
# Weight of the command, relative to the inverse square of the voltage limit.
EFFORT = 100.0
# Largest arm error [rad] that is fed back.
ARM_ERROR = 1.0


class Catching(NamedTuple):
    """Gain L, γ/β, ω [rad/s] and the arm's reference [rad]."""

    gain: Gain = Gain(0.0, 0.0, 0.0, 0.0)
    ratio: float = 1.0
    frequency: float = 1.0
    arm_reference: float = 0.0

    @property
    def is_finite(self) -> bool:
        """Whether there is a feedback."""
        return bool(np.all(np.isfinite((*self.gain, *self[1:]))))


def design(rig: ControlledRig, limits: ArmLimits, arm_reference: float) -> Catching:
    """The feedback for a rig; NaN if there is none."""
    from scipy.linalg import solve_continuous_are  # slow; not every node needs it

    model = rig.model
    frequency = sqrt(model.delta / model.beta)
    a, b = linearize(model)
    deviations = np.array(
        (
            ARM_DEVIATION * min(limits.travel, pi),
            limits.speed,
            PENDULUM_DEVIATION,
            PENDULUM_DEVIATION * frequency,
        )
    )
    try:
        effort = EFFORT / rig.voltage_limit**2
        cost = solve_continuous_are(a, b[:, None], np.diag(deviations**-2), effort * np.eye(1))
        gain = Gain(*(b @ cost / effort).tolist())
    except (np.linalg.LinAlgError, ArithmeticError, ValueError):
        gain = Gain(nan, nan, nan, nan)
    return Catching(gain, model.gamma / model.beta, frequency, arm_reference)


@inlined
def can_catch(x: np.ndarray, limits: ArmLimits, p: Catching) -> bool:
    """Whether the pendulum can be caught in state ``x``."""
    if abs(x[THETA]) > CATCH_ANGLE or abs(x[PHI]) > CATCH_TRAVEL * limits.travel:
        return False
    # The arm's speed [rad/s] that stops the unstable part, and the travel in its direction [rad].
    speed = x[PHI_DOT] + (x[THETA_DOT] + p.frequency * x[THETA]) / p.ratio
    travel = limits.travel - (x[PHI] if speed > 0.0 else -x[PHI])
    return (
        abs(speed) < USED_SHARE * limits.speed
        and abs(speed) < USED_TRAVEL_SHARE * p.frequency * travel
    )


@inlined
def command(x: np.ndarray, friction: float, p: Catching) -> float:
    """Command u [V], unsaturated, for state ``x`` and friction estimate [V]."""
    error = min(max(x[PHI] - p.arm_reference, -ARM_ERROR), ARM_ERROR)
    return fed_back(friction, error, x[PHI_DOT], x[THETA], x[THETA_DOT], p.gain)
