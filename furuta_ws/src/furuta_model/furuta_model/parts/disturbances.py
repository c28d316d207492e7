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

# Most pushes, and most waves.
LONGEST = 16
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
        _check_lengths("pushes", "one length, or 1", lengths)

    @property
    def number(self) -> int:
        """Number of pushes; 0 if none pushes."""
        sizes = self.arm, self.pendulum, self.base_x, self.base_y
        return max(map(len, self)) if any(map(any, sizes)) else 0

    def profile(self, dt: float) -> np.ndarray:
        """The pushes as an array (:data:`LONGEST`, 6) in samples of ``dt`` [s]."""
        table = np.zeros((LONGEST, 6))
        rows = table[: self.number]
        for column, given in enumerate(self):
            rows[:, column] = given if len(given) > 1 else given[0]
        starts, durations = rows[:, FIRST], rows[:, AFTER]
        rows[:, AFTER] = np.rint((starts + durations) / dt)
        rows[:, FIRST] = np.rint(starts / dt)
        return table


def _check_lengths(kind: str, rule: str, lengths: dict[str, int]) -> None:
    """Reject lists of different lengths, and too long ones."""
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
        raise ParameterError(f"lists of {kind} must have {rule}; given {listed}")
    if max(lengths.values(), default=0) > LONGEST:
        number = max(lengths.values())
        raise ParameterError(f"at most {LONGEST} {kind} are possible, given {number}")


class Tilt(NamedTuple):
    """Components of the upward vertical in the plane of the arm."""

    x: Annotated[float, About("tilt of the base, along the arm at angle 0", "rad", -0.5, 0.5)] = 0.0
    y: Annotated[float, About("tilt of the base, across the arm at angle 0", "rad", -0.5, 0.5)] = (
        0.0
    )


class Push(NamedTuple):
    """What pushes in a sample: torques [V] and acceleration of the base [g]."""

    arm: float
    pendulum: float
    base_x: float
    base_y: float


@inlined
def push_at(sample: float, profile: np.ndarray, count: int, tilt: Tilt) -> Push:
    """The sum of the pushes in a sample, with the tilt as an acceleration of the base."""
    arm = pendulum = base_x = base_y = 0.0
    for k in range(count):
        if profile[k, FIRST] <= sample < profile[k, AFTER]:
            arm += profile[k, ARM]
            pendulum += profile[k, PENDULUM]
            base_x += profile[k, BASE_X]
            base_y += profile[k, BASE_Y]
    return Push(arm, pendulum, base_x + tilt.x, base_y + tilt.y)


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
        _check_lengths("waves", "one length", lengths)

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
