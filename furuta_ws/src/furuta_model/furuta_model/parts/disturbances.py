"""Disturbances of the motion: pushes, tilt of the base, torque that varies with the arm's angle.

Push k lasts from ``times[k]`` for ``durations[k]``, both rounded to samples, and is constant
meanwhile. Time counts from when the rig is released, or from a later change of the pushes. Pushes
may overlap; they add up.

A horizontal acceleration of the base acts on the pendulum like a tilt of gravity; ``base_x`` is
along the arm at angle 0. The arm is assumed to be balanced about its axis. A small tilt of the
base, where gravity is not parallel to the arm's axis, acts like a constant acceleration of it in
units of gravity.

The torque of waves Σ aₖ cos nₖφ + bₖ sin nₖφ, as ``furuta identify`` finds them, is added to that
of the drive. Order 1 is an unbalanced arm on a tilted base, higher orders are ripple and cogging of
the motor.
"""

from math import cos, sin
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import sin_cos
from furuta_model.parameters import About, ParameterError

MAX_PUSHES, MAX_WAVES = 16, 16
# Columns of the profile: first sample, first sample after the end, and the four sizes.
FIRST, AFTER, ARM, PENDULUM, BASE_X, BASE_Y = range(6)
# Columns of a wave.
ORDER, COSINE, SINE = range(3)

Numbers = tuple[float, ...]


class Pushes(NamedTuple):
    """The profile. A list with one element applies to every push."""

    times: Annotated[Numbers, About("start of each push", "s", 0, 1e6)] = (0.0,)
    durations: Annotated[Numbers, About("duration of each push", "s", 0, 1e6)] = (0.0,)
    arm: Annotated[Numbers, About("torque on the arm", "V", -1e3, 1e3)] = (0.0,)
    pendulum: Annotated[Numbers, About("torque on the pendulum's joint", "V", -1e3, 1e3)] = (0.0,)
    base_x: Annotated[
        Numbers, About("acceleration of the base along the arm at angle 0", "g", -10, 10)
    ] = (0.0,)
    base_y: Annotated[
        Numbers, About("acceleration of the base across the arm at angle 0", "g", -10, 10)
    ] = (0.0,)

    def check(self) -> None:
        """Reject lists of different lengths."""
        lengths = {name: len(given) for name, given in self._asdict().items() if len(given) > 1}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise ParameterError(f"lists of pushes must have one length, or 1; given {listed}")
        if max(lengths.values(), default=1) > MAX_PUSHES:
            raise ParameterError(
                f"at most {MAX_PUSHES} pushes are possible, given {max(lengths.values())}"
            )

    @property
    def number(self) -> int:
        """Number of pushes; 0 if none pushes."""
        if not any(any(sizes) for sizes in self[2:]):
            return 0
        return max(map(len, self))

    def profile(self, dt: float) -> np.ndarray:
        """The pushes as an array (:data:`MAX_PUSHES`, 6) in samples of ``dt`` [s]."""
        table = np.zeros((MAX_PUSHES, 6))
        rows = table[: self.number]
        for column, given in enumerate(self):
            rows[:, column] = given if len(given) > 1 else given[0]
        rows[:, AFTER] = np.rint((rows[:, FIRST] + rows[:, AFTER]) / dt)
        rows[:, FIRST] = np.rint(rows[:, FIRST] / dt)
        return table


class Push(NamedTuple):
    """What pushes in a sample: torques [V] and acceleration of the base [g]."""

    arm: float
    pendulum: float
    base_x: float
    base_y: float


@inlined
def push_at(sample: float, profile: np.ndarray, count: int) -> Push:
    """The sum of the pushes in a sample."""
    arm = pendulum = base_x = base_y = 0.0
    for k in range(count):
        if profile[k, FIRST] <= sample < profile[k, AFTER]:
            arm += profile[k, ARM]
            pendulum += profile[k, PENDULUM]
            base_x += profile[k, BASE_X]
            base_y += profile[k, BASE_Y]
    return Push(arm, pendulum, base_x, base_y)


@compiled
def push_torques(
    phi: float, sine: float, cosine: float, delta: float, p: Push
) -> tuple[float, float]:
    """Torques [V] on arm and pendulum at φ and θ; ``delta`` is the gravity torque [V]."""
    if p.base_x == 0.0 and p.base_y == 0.0:
        return p.arm, p.pendulum
    across, along = sin_cos(phi)
    arm = delta * sine * (p.base_x * along + p.base_y * across)
    return p.arm + arm, p.pendulum - delta * cosine * (p.base_y * along - p.base_x * across)


class Tilt(NamedTuple):
    """Components of the upward vertical in the plane of the arm."""

    x: Annotated[float, About("tilt of the base, along the arm at angle 0", "rad", -0.5, 0.5)] = 0.0
    y: Annotated[float, About("tilt of the base, across the arm at angle 0", "rad", -0.5, 0.5)] = (
        0.0
    )


@compiled
def with_tilt(push: Push, p: Tilt) -> Push:
    """The push with the tilt as an acceleration of the base."""
    return Push(push.arm, push.pendulum, push.base_x + p.x, push.base_y + p.y)


class TorqueWaves(NamedTuple):
    """The waves: three lists of one length."""

    orders: Annotated[
        Numbers, About("periods per turn of each wave", "", 0, 10_000, shape=True)
    ] = (0.0,)
    cosine: Annotated[Numbers, About("amplitude of cos(order φ)", "V", -10, 10)] = (0.0,)
    sine: Annotated[Numbers, About("amplitude of sin(order φ)", "V", -10, 10)] = (0.0,)

    def check(self) -> None:
        """Reject lists of different lengths, and too many waves."""
        lengths = {name: len(given) for name, given in self._asdict().items()}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise ParameterError(f"lists of waves must have one length; given {listed}")
        if len(self.orders) > MAX_WAVES:
            raise ParameterError(f"at most {MAX_WAVES} waves are possible, given {lengths}")

    @property
    def table(self) -> np.ndarray:
        """The waves that are not zero (k, 3): order, factors of cosine and sine [V]."""
        waves = [each for each in zip(*self, strict=True) if each[COSINE] or each[SINE]]
        return np.array(waves).reshape(-1, 3)


@inlined
def wave_torque(phi: float, waves: np.ndarray) -> float:
    """Torque [V] of the ``waves`` (k, 3) at arm angle φ [rad]."""
    torque = 0.0
    for k in range(waves.shape[0]):
        angle = waves[k, ORDER] * phi
        torque += waves[k, COSINE] * cos(angle) + waves[k, SINE] * sin(angle)
    return torque
