r"""A PID whose integral is reset, sampled, on an axis with friction that truly sticks.

When the error changes sign, the integral that moved the axis pushes it away from its reference.
There its sign is reversed: :math:`I^+ = -I`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from furuta.axis.axis import Axis, Pid, servo_cycle
from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw, friction_law, sticking_force
from furuta_model.friction.lugre import highest_level

SAMPLE = 2e-4  # of the sampling, relative to sqrt(J/k_p)
RELEASED_AT = 2.0  # error at the start, relative to what k_p alone leaves

# Laws and k_d of the table, duration [1/sqrt(k_p/J)], and what counts as settled.
CASES = (("stribeck", 0.5), ("stribeck", 1.0), ("stiction", 0.5), ("stiction", 2.0))
DURATION, SETTLED = 3000.0, 1e-6


class Settling(NamedTuple):
    """Peak to peak of the error in the last part of a run, and the largest error there."""

    peak_to_peak: float
    error: float


def settling(axis: Axis, pid: Pid, reset: bool, seconds: float, part: float = 0.3) -> Settling:
    """How the axis moves in the last ``part`` of a run of ``seconds`` [s] to a reference."""
    sample_time = SAMPLE * float(np.sqrt(axis.inertia / pid.kp))
    errors = np.empty(int(seconds / sample_time))
    errors[0] = RELEASED_AT * highest_level(axis.friction) / pid.kp
    law = friction_law(axis.law, axis.friction)
    _run(errors, axis.inertia, law, pid, sample_time, reset)
    last = errors[int((1.0 - part) * len(errors)) :]
    return Settling(float(np.ptp(last)), float(np.abs(last).max()))


@compiled
def _run(
    errors: np.ndarray, inertia: float, law: FrictionLaw, pid: Pid, dt: float, reset: bool
) -> None:
    """Fill ``errors`` from its first element on, with the axis released at rest."""
    error, v, integral = errors[0], 0.0, 0.0
    for n in range(1, len(errors)):
        torque = pid.kp * error - pid.kd * v + pid.ki * integral
        holding = torque + inertia * v / dt
        force = sticking_force(v, v, holding, law) + law.parameters.viscous * v
        v += dt / inertia * (torque - force)
        error -= dt * v
        if reset and error * errors[n - 1] < 0.0:
            integral = -integral
        integral += dt * error
        errors[n] = error


def reset_rows(axis: Axis, gains: Pid) -> tuple[list[dict[str, Any]], bool]:
    """The error of PID and of PID with reset; whether the latter settles where the former hunts."""
    rows, held = [], True
    for law, kd in CASES:
        case, pid = axis._replace(law=law), gains._replace(kd=kd)
        exact = servo_cycle(case, pid)
        seconds = DURATION / float(np.sqrt(pid.kp / axis.inertia))
        plain, reset = (settling(case, pid, each, seconds) for each in (False, True))
        rows.append(
            {
                "law": law,
                "kd": kd,
                "exact_peak_to_peak_rad": exact.peak_to_peak,
                "pid_peak_to_peak_rad": plain.peak_to_peak,
                "reset_largest_error_rad": reset.error,
            }
        )
        held = held and reset.error < SETTLED * plain.peak_to_peak
    return rows, held
