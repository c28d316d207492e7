"""Measures the friction of a rig: Coulomb, stiction and viscous, by direction."""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from furuta_hw.commissioning.session import Experiment, ramp
from furuta_hw.connection.rig_driver import RigSample
from furuta_hw.errors import RigError
from furuta_hw.rigs.channels import wrapped
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError

# Speed at which the arm counts as broken away: well above noise and creep [rad/s].
BREAK_AWAY_SPEED = 0.1
# Time constant of the low-pass filter of the speed that detects the break-away [s].
SMOOTHING = 0.05
# Speeds of the slides [rad/s], well above the Stribeck effect.
SLIDE_SPEEDS = (0.3, 0.6)
SLIDE_DIRECTIONS = (1, -1, -1, 1)
# Bandwidth of the speed control of a slide [rad/s], and its settling time [s].
BANDWIDTH = 10.0
SETTLING_TIME = 1.0
REST_TIME = 0.5  # [s] at 0 V between two motions
RAMPS = 3  # in each direction
# Largest angle [rad] between the pendulum and hanging, and largest change of it, at the start.
HANGING_RANGE = 0.25 * pi
STILL_RANGE = 0.1


@dataclass(frozen=True)
class FrictionLevels:
    """Friction levels [V] by direction, as magnitudes; ``viscous`` [V s/rad]."""

    coulomb_positive: float
    coulomb_negative: float
    stiction_positive: float
    stiction_negative: float
    viscous: float

    @property
    def alpha0(self) -> float:
        """Coulomb level [V], the mean of both directions."""
        return 0.5 * (self.coulomb_positive + self.coulomb_negative)

    @property
    def alpha1(self) -> float:
        """Stiction above the Coulomb level [V]."""
        return max(0.0, 0.5 * (self.stiction_positive + self.stiction_negative) - self.alpha0)

    @property
    def asymmetry(self) -> float:
        """Relative difference of the directions: levels are (1 ± asymmetry) times the mean."""
        return (self.coulomb_positive - self.coulomb_negative) / (2.0 * self.alpha0)


def check_hanging(samples: Sequence[RigSample]) -> None:
    """Check that the pendulum hangs at rest, as far as its sensor shows that.

    An upright or swinging pendulum pulls at the arm, and its torque would count as friction. A
    sensor at the end of its range shows only that the pendulum is not upright. Raises
    :class:`RigError`.
    """
    seen = [sample.pendulum_angle for sample in samples if not sample.at_rail]
    if not seen:
        return
    angles = np.array([wrapped(angle - pi) for angle in seen])  # zero hanging
    furthest = angles[np.argmax(np.abs(angles))]
    if abs(furthest) > HANGING_RANGE:
        raise RigError(
            f"the pendulum must hang, but its sensor reads {wrapped(furthest + pi):.2f} rad "
            "(0 is upright); let it hang, or give --removed if there is none"
        )
    if np.ptp(angles) > STILL_RANGE:
        raise RigError(
            f"the pendulum swings by {np.ptp(angles):.2f} rad; wait until it hangs at rest"
        )


def check_arm_range(rig: Rig, arm_range: float) -> None:
    """Check that the slides fit into ``arm_range`` [rad]; raises :class:`ParameterError`."""
    needed = max(SLIDE_SPEEDS) * (SETTLING_TIME + _swing_period(rig)) * 1.2
    if arm_range < needed:
        raise ParameterError(
            f"arm range must be at least {needed:.2f} rad for this rig, given {arm_range:g}"
        )


def measure_friction(
    rig: Rig, rate: float, report: Callable[[str], None], voltage: float | None = None
) -> Experiment[FrictionLevels]:
    """Measure friction by voltage ramps until the arm breaks away, and by slow slides.

    The stiction level is the median voltage of the ramps, rising by ``rate`` [V/s], at which the
    arm breaks away. While the arm slides at a constant speed v under a speed control, its voltage
    is the friction at v: levels and viscous friction are the straight line through all slides.
    ``report`` is called before each motion. Raises :class:`RigError` if the arm does not move as it
    should at ``voltage`` [V], by default the rig's limit.
    """
    voltage = rig.limits.voltage if voltage is None else voltage
    yield 0.0
    stiction = yield from _ramps(rig, rate, voltage, report)
    positive, negative, viscous = yield from _slides(rig, voltage, report)
    # The filtered speed reaches BREAK_AWAY_SPEED a time SMOOTHING after the arm has reached it.
    excess = viscous * BREAK_AWAY_SPEED + rate * SMOOTHING
    return FrictionLevels(
        positive,
        negative,
        float(np.median(stiction[1])) - excess,
        float(np.median(stiction[-1])) - excess,
        viscous,
    )


def _ramps(
    rig: Rig, rate: float, voltage: float, report: Callable[[str], None]
) -> Experiment[dict[int, list[float]]]:
    """Return the voltages [V] of all break-aways by direction."""
    stiction: dict[int, list[float]] = {1: [], -1: []}
    for number in range(RAMPS):
        for k, direction in enumerate((1, -1)):
            report(f"ramp {2 * number + k + 1} of {2 * RAMPS}")
            stiction[direction].append((yield from _break_away(rig, direction, rate, voltage)))
            yield from _rest(rig)
    return stiction


def _slides(
    rig: Rig, voltage: float, report: Callable[[str], None]
) -> Experiment[tuple[float, float, float]]:
    """Return the levels [V] in positive and negative direction, and the viscous friction."""
    slides: list[tuple[int, float, float]] = []
    for speed in SLIDE_SPEEDS:
        for direction in SLIDE_DIRECTIONS:
            number, last = len(slides) + 1, len(SLIDE_SPEEDS) * len(SLIDE_DIRECTIONS)
            report(f"slide {number} of {last}")
            slides.append((direction, *(yield from _slide(rig, direction * speed, voltage))))
            yield from _rest(rig)
    # |u| = level of the direction + viscous |v|
    rows = np.array([(d > 0, d < 0, abs(v)) for d, v, _ in slides], dtype=float)
    level = np.linalg.lstsq(rows, np.array([abs(u) for _, _, u in slides]), rcond=None)[0]
    return float(level[0]), float(level[1]), float(max(level[2], 0.0))


def _rest(rig: Rig) -> Generator[float, RigSample, None]:
    for _ in range(round(REST_TIME / rig.line.sample_time)):
        yield 0.0


def _break_away(rig: Rig, direction: int, rate: float, voltage: float) -> Experiment[float]:
    """Return the voltage [V] at which the arm breaks away from a ramp up to ``voltage``."""
    dt = rig.line.sample_time
    voltages = ramp(rate, voltage, dt)
    u = speed = 0.0
    while direction * speed < BREAK_AWAY_SPEED:
        sample = yield direction * u
        speed += (sample.arm_speed - speed) * dt / SMOOTHING
        u = next(voltages)
    return u


def _swing_period(rig: Rig) -> float:
    """Period [s] of the hanging pendulum while the arm moves at a constant speed."""
    return 2.0 * pi * sqrt(rig.model.beta / rig.model.delta)


def _slide(rig: Rig, speed: float, voltage: float) -> Experiment[tuple[float, float]]:
    """Return mean speed [rad/s] and voltage [V] of a slide, over one swing of the pendulum.

    Over a whole swing the pendulum's mean torque on the arm is zero. Beyond ``voltage`` [V] the rig
    does not get what the speed control asks for.
    """
    dt = rig.line.sample_time
    mobility = rig.model.beta / rig.model.determinant
    proportional, integral = 2 * BANDWIDTH / mobility, BANDWIDTH**2 / mobility
    integrated = 0.0
    rows = []
    sample = yield 0.0
    for _ in range(round((SETTLING_TIME + _swing_period(rig)) / dt)):
        error = speed - sample.arm_speed
        integrated += integral * error * dt
        u = proportional * error + integrated
        sample = yield u
        rows.append((sample.arm_speed, u))
    swing = np.array(rows[-round(_swing_period(rig) / dt) :])
    if np.abs(swing[:, 1]).max() > voltage:
        raise RigError(
            f"the arm did not slide at {abs(speed):g} rad/s at {voltage:g} V; raise --voltage or "
            "check the motor"
        )
    return float(swing[:, 0].mean()), float(swing[:, 1].mean())
