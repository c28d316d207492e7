"""What is found out on a rig before it is controlled; cores on samples, without line or clock."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from math import pi, sqrt
from typing import NamedTuple

import numpy as np

from furuta_hw.codes import wrapped
from furuta_hw.errors import NotStillError
from furuta_hw.frames import Sensors
from furuta_hw.rig import Rig
from furuta_hw.session import Experiment
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA

# A sensor at rest moves by no more than this many codes, peak to peak, with its noise.
STILL = 16
# Speed at which the arm counts as broken away: well above noise and creep [rad/s].
MOVING = 0.1
# The break-away is seen on the speed behind a low-pass of this time [s].
SMOOTHING = 0.05
# Speeds of the slides [rad/s], well above the Stribeck effect.
SPEEDS = (0.3, 0.6)
# Bandwidth of the speed control of a slide [rad/s], and its time to settle [s].
BANDWIDTH = 10.0
SETTLING = 1.0
REST = 0.5  # [s] at 0 V between two motions
RATE = 0.05  # [V/s] of the ramps
REPEATS = 3


class Statistics(NamedTuple):
    """Mean and peak-to-peak of each sensor's codes over a while, and the mean measurement."""

    arm_code: float
    speed_code: float
    pendulum_code: float
    arm_spread: int
    speed_spread: int
    pendulum_spread: int
    samples: int


def statistics(samples: Sequence[Sensors]) -> Statistics:
    """Of the codes of all ``samples``."""
    codes = np.array([(s.arm, s.speed, s.pendulum) for s in samples])
    means, spreads = codes.mean(axis=0), np.ptp(codes, axis=0)
    (arm, speed, pendulum), (a, s, p) = map(float, means), map(int, spreads)
    return Statistics(arm, speed, pendulum, a, s, p, len(samples))


def zeros(samples: Sequence[Sensors], rig: Rig, hanging: bool) -> dict[str, float]:
    """The codes at zero: the arm here, the pendulum upright (or hanging), the arm at rest.

    Raises :class:`NotStillError` where something moves.
    """
    found = statistics(samples)
    pendulum = found.pendulum_code
    for name, spread in (("arm", found.arm_spread), ("pendulum", found.pendulum_spread)):
        if spread > STILL:
            raise NotStillError(f"the {name} moves: its code varied by {spread}; hold it still")
    if rig.pendulum.sensor == "potentiometer" and (rig.pendulum.channel.at_rail(round(pendulum))):
        raise NotStillError("the pendulum's sensor is at the end of its range")
    if hanging:
        pendulum += pi / rig.pendulum.channel.per_code
    result = {"arm.zero": round(found.arm_code), "pendulum.zero": round(pendulum, 1)}
    if rig.speed.sensor == "tachometer":
        result["speed.zero"] = round(found.speed_code, 1)
    return result


class Signs(NamedTuple):
    """Signs to put into the rig file, None where nothing was seen."""

    arm: int | None
    speed: int | None
    pendulum: int | None


def signs(rig: Rig, voltage: float) -> Experiment[Signs]:
    """Nudge the arm with a positive voltage and see which way the sensors go.

    A hanging pendulum, if its sensor sees it, lags behind: by (1) its angle θ then grows with φ.
    """
    x = yield 0.0
    start, u = x.copy(), 0.0
    moved = max(3 * abs(rig.arm.channel.per_code), 0.02)
    speed = 0.0
    while abs(x[PHI] - start[PHI]) < moved:
        u = min(u + rig.line.sample_time, voltage)
        x = yield u
        speed += x[PHI_DOT] * rig.line.sample_time
    arm = rig.arm.sign * (1 if x[PHI] > start[PHI] else -1)
    same = (speed > 0) == (x[PHI] > start[PHI])
    hanging = abs(start[THETA]) > 0.75 * pi and abs(wrapped(x[THETA] - start[THETA])) > 0
    pendulum = (
        rig.pendulum.sign * (1 if wrapped(x[THETA] - start[THETA]) > 0 else -1) if hanging else None
    )
    tachometer = rig.speed.sensor == "tachometer"
    turned = arm != rig.arm.sign
    speed_sign = rig.speed.sign * (1 if same else -1) * (-1 if turned else 1)
    return Signs(arm, speed_sign if tachometer else None, pendulum)


class FrictionLevels(NamedTuple):
    """Friction of a rig [V], magnitudes by direction; ``viscous`` [V s/rad]."""

    coulomb_positive: float
    coulomb_negative: float
    stiction_positive: float
    stiction_negative: float
    viscous: float

    @property
    def alpha0(self) -> float:
        """Coulomb level, the mean of both directions."""
        return 0.5 * (self.coulomb_positive + self.coulomb_negative)

    @property
    def alpha1(self) -> float:
        """Stiction above it."""
        return max(0.0, 0.5 * (self.stiction_positive + self.stiction_negative) - self.alpha0)

    @property
    def asymmetry(self) -> float:
        """By how much levels differ by direction: (1 ± asymmetry) times."""
        return (self.coulomb_positive - self.coulomb_negative) / (2.0 * self.alpha0)


def measure_friction(rig: Rig, travel: float, rate: float = RATE) -> Experiment[FrictionLevels]:
    """Ramps until the arm breaks away, and slides at two slow speeds, in both directions.

    Stiction is the voltage of the ramp, rising by ``rate`` [V/s], when the arm moves: the median
    of all. While the arm slides at a constant speed v under a speed control, its voltage is the
    friction at v: levels and viscous friction are the line through all slides. Raises
    :class:`ParameterError` where ``travel`` [rad] has no room for that.
    """
    room = max(SPEEDS) * (SETTLING + _swing(rig)) * 1.2
    if travel < room:
        raise ParameterError(
            f"travel must be at least {room:.2f} rad for this rig, given {travel:g}"
        )
    stiction: dict[int, list[float]] = {1: [], -1: []}
    slides: list[tuple[int, float, float]] = []
    yield 0.0
    for _ in range(REPEATS):
        for direction in (1, -1):
            stiction[direction].append((yield from _break_away(rig, direction, rate)))
            yield from _rest(rig)
    for speed in SPEEDS:
        for direction in (1, -1, -1, 1):
            slides.append((direction, *(yield from _slide(rig, direction * speed))))
            yield from _rest(rig)
    # |u| = level of the direction + viscous |v|
    rows = np.array([(d > 0, d < 0, abs(v)) for d, v, _ in slides], dtype=float)
    level = np.linalg.lstsq(rows, np.array([abs(u) for _, _, u in slides]), rcond=None)[0]
    viscous = float(max(level[2], 0.0))
    # Seen at MOVING, SMOOTHING later than it was so.
    extra = viscous * MOVING + rate * SMOOTHING
    return FrictionLevels(
        float(level[0]),
        float(level[1]),
        float(np.median(stiction[1])) - extra,
        float(np.median(stiction[-1])) - extra,
        viscous,
    )


def _rest(rig: Rig) -> Generator[float, np.ndarray, None]:
    for _ in range(round(REST / rig.line.sample_time)):
        yield 0.0


def _break_away(rig: Rig, direction: int, rate: float) -> Experiment[float]:
    """The voltage [V] at which the arm moves."""
    dt = rig.line.sample_time
    u = speed = 0.0
    while direction * speed < MOVING:
        x = yield direction * u
        speed += (x[PHI_DOT] - speed) * dt / SMOOTHING
        u += rate * dt
    return u


def _swing(rig: Rig) -> float:
    """Period [s] of the hanging pendulum while the arm moves at a constant speed."""
    return 2.0 * pi * sqrt(rig.model.beta / rig.model.delta)


def _slide(rig: Rig, speed: float) -> Experiment[tuple[float, float]]:
    """Mean speed [rad/s] and voltage [V] of a slide, over one swing of the pendulum.

    Over a whole swing the pendulum takes as much torque from the arm as it gives.
    """
    dt = rig.line.sample_time
    mobility = rig.model.beta / rig.model.determinant
    proportional, integral = 2 * BANDWIDTH / mobility, BANDWIDTH**2 / mobility
    total = 0.0
    rows = []
    x = yield 0.0
    for _ in range(round((SETTLING + _swing(rig)) / dt)):
        error = speed - x[PHI_DOT]
        total += integral * error * dt
        u = proportional * error + total
        x = yield u
        rows.append((x[PHI_DOT], u))
    swing = np.array(rows[-round(_swing(rig) / dt) :])
    return float(swing[:, 0].mean()), float(swing[:, 1].mean())
