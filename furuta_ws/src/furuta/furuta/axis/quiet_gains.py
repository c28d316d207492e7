"""Gains with which an axis does not stick and slip behind a moving reference, or with a bristle.

More damping is tried, and less integral action, by the smallest change first. The exact motions
from all starts must not hunt, for the axis and nearly all others that a recording may come from.
They have neither samples nor delay, so the loop is simulated with both. Starts between these may
still hunt. Behind a reference at rest, :mod:`furuta.axis.cures` finds what ends the hunting from
all starts.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log, pi, sqrt
from typing import Any, NamedTuple

from furuta.axis.axis import HUNTING, Axis, Cascade, Controller, servo_motions
from furuta.axis.compensations import COUNTS, residual
from furuta.axis.cures import FEW
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen

# Factors of the damping and of the integral action that are tried.
DAMPING, INTEGRAL = (1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0), (1.0, 0.5, 0.2, 0.1, 0.0)


class QuietGains(NamedTuple):
    """The controller that does not hunt from the starts that were tried, or None."""

    controller: Controller | None

    def sentence(self) -> str:
        """What ends the hunting, in words."""
        tried = f"damping up to {DAMPING[-1]:g} times and integral action down to 0"
        if self.controller is None:
            return f"no gains that were tried do, with {tried}"
        gains = self.controller._asdict().items()
        text = ", ".join(f"{name} {value:.4g}" for name, value in gains if value)
        return f"of what was tried, {tried}, it is the smallest change: {text}"


def quiet_gains(
    axis: Axis,
    controller: Controller,
    *,
    speed: float = 0.0,
    counts: int = 4096,
    sample_time: float = 1e-3,
    delay: float = 0.0,
    others: Sequence[Axis] = (),
    progress: Progress = unseen,
) -> QuietGains:
    """The smallest change of gains with which the axis does not hunt without compensation.

    Nor do nearly all ``others``, such as what a recording leaves open. The rest is as of
    :func:`furuta.axis.compensations.compare_on_axis`.
    """
    loop = {"speed": speed, "counts": counts, "sample_time": sample_time, "delay": delay}
    candidates = _candidates(controller, axis.inertia)
    for gains in progress(candidates, len(candidates)):
        if any(motion.kind not in ("rest", "steady") for motion in _motions(axis, gains, speed)):
            continue
        hunting = sum(
            any(motion.kind in HUNTING for motion in _motions(other, gains, speed))
            for other in others
        )
        if hunting <= FEW * len(others) and _rests(axis, gains, **loop):
            return QuietGains(gains)
    return QuietGains(None)


def _motions(axis: Axis, controller: Controller, speed: float) -> Sequence[Any]:
    return tuple(servo_motions(axis, controller, speed).values())


def _rests(axis: Axis, controller: Controller, **loop: Any) -> bool:
    """Whether the sampled loop comes to rest, or follows steadily."""
    try:
        left = residual(axis, axis, controller, "none", **loop)
    except ParameterError:  # the motion grows beyond all numbers
        return False
    still = COUNTS * 2.0 * pi / loop["counts"] if loop["counts"] else 1e-6 * left.error_rad
    return left.settled and left.peak_to_peak_rad <= still


def _candidates(controller: Controller, inertia: float) -> list[Controller]:
    """Other gains, those without integral action last, else by the size of the change."""

    def change(factors: tuple[float, float]) -> tuple[bool, float]:
        damping, integral = factors
        return integral == 0.0, log(damping) - log(integral or 1.0)

    pairs = sorted(((d, i) for d in DAMPING for i in INTEGRAL), key=change)
    changed = (_changed(controller, inertia, *factors) for factors in pairs)
    return [each for each in dict.fromkeys(changed) if each != controller]


def _changed(controller: Controller, inertia: float, damping: float, integral: float) -> Controller:
    """Other gains; a PID without damping gets that of a damping ratio of 0.5."""
    if isinstance(controller, Cascade):
        return controller._replace(
            speed=damping * controller.speed, integral=integral * controller.integral
        )
    kd = controller.kd or sqrt(controller.kp * inertia)
    return controller._replace(kd=damping * kd, ki=integral * controller.ki)
