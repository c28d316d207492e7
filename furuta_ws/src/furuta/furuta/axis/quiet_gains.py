"""Gains with which an axis does not hunt, and gains in the unit of a recording.

More damping is tried, and less integral action, by the smallest change first. The exact motions
from all starts must not hunt, for the axis and nearly all others that a recording may come from.
They have neither samples nor delay, so the loop is simulated with both. With friction that falls at
once after breakaway, an axis with integral action hunts whatever its gains (Armstrong and Amin
1996). Then only gains without it are left.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import log, pi, sqrt
from typing import Any, NamedTuple

from furuta.axis.axis import Axis, Cascade, Controller, Pid, poles, servo_motions
from furuta.axis.compensations import residual
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen

# Motions without end about a reference at rest.
HUNTING = ("limit_cycle", "irregular")
# Factors of the damping and of the integral action that are tried.
DAMPING, INTEGRAL = (1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0), (1.0, 0.5, 0.2, 0.1, 0.0)
# Factors of a gain with which an unstable loop may be stable.
CHANGES = [1.05**k for k in range(-200, 201)]
# Counts by which an axis at rest may move, and most of the other axes that may hunt.
COUNTS, FEW = 2.0, 0.05
# Units of the gains per unit of the position, which stands for {q}, and of the torque {f}.
UNITS = {
    Pid: {"kp": "{f}/{q}", "ki": "{f}/({q} s)", "kd": "{f} s/{q}"},
    Cascade: {"position": "1/s", "speed": "{f} s/{q}", "integral": "{f}/{q}"},
}


class QuietGains(NamedTuple):
    """The controller that ends the hunting, or None; the error [rad] within which it then rests."""

    controller: Controller | None
    error: float

    def sentence(self) -> str:
        """What ends the hunting, in words."""
        if self.controller is None:
            return (
                f"no gains that were tried: damping up to {DAMPING[-1]:g} times, integral action "
                "down to 0"
            )
        gains = self.controller._asdict().items()
        text = ", ".join(f"{name} {value:.4g}" for name, value in gains if value)
        if _integral(self.controller):
            return text
        return (
            f"only no integral action, of what was tried: {text}; friction then holds the axis "
            f"within {self.error:.3g} of the reference"
        )


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
            return QuietGains(gains, highest_level(axis.friction) / max(gains.stiffness, 1e-300))
    return QuietGains(None, float("nan"))


def stable_gains(axis: Axis, controller: Controller) -> dict[str, float]:
    """The nearest value of each gain that alone makes the loop stable without friction, if any."""
    found = {}
    for name, given in controller._asdict().items():
        usual = given or sqrt(axis.inertia * controller.stiffness)
        for factor in sorted(CHANGES, key=lambda each: abs(log(each))):
            value = float(f"{factor * usual:.2g}")
            found_poles = poles(axis, controller._replace(**{name: value}))
            if max(found_poles.real) < -1e-3 * min(abs(found_poles)):
                found[name] = value
                break
    return found


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


def _integral(controller: Controller) -> float:
    return controller.integral if isinstance(controller, Cascade) else controller.ki


def gain_rows(
    controller: Controller,
    quiet: Controller | None,
    units: tuple[str, str],
    recorded: tuple[str, float],
) -> list[dict[str, Any]]:
    """Each gain with its unit, as given and quiet, and per unit of the recorded position.

    Args:
        controller: The given gains.
        quiet: Gains without hunting, if they are known.
        units: Those of position and torque.
        recorded: The unit of the recorded position, and its size in that of position.
    """
    rows = []
    (position, torque), (other, size) = units, recorded
    for name, form in UNITS[type(controller)].items():
        row: dict[str, Any] = {"gain": name, "unit": form.format(q=position, f=torque)}
        values = {"given": getattr(controller, name)}
        if quiet is not None:
            values["quiet"] = getattr(quiet, name)
        row |= values
        if other != position and "{q}" in form:
            row["recorded_unit"] = form.format(q=other, f=torque)
            row |= {f"{kind}_recorded": size * value for kind, value in values.items()}
        rows.append(row)
    return rows
