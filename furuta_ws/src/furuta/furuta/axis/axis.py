r"""An axis with friction, and its position controller, as a linear loop with one friction joint.

.. math::
    J \dot v = τ - F - σ_2 v, \qquad e = q_r - q, \qquad \dot q_r = V

The controllers are

- PID: :math:`τ = k_p e + k_i \int e\,dt + k_d\,s/(1 + T s)\,e`;
- cascade: :math:`v_r = k e`, :math:`τ = k_v (v_r - v) + k_i \int (v_r - v)\,dt`.

Units are kg m², rad and N m, or kg, m and N.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, NamedTuple

import numpy as np

from furuta.limit_cycles.joint import Joint, JointCycle, final_motion, joint
from furuta.limit_cycles.linear_loop import BRISTLE, W
from furuta_model.friction.laws import check_friction
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import About, ParameterError
from furuta_model.progress import Progress, unseen

# Error at the start, as a multiple of that which friction can hold without integral action.
RELEASED_AT = 20.0
# A small disturbance, relative to that error, or of the steady motion; difference of motions that
# are one.
DISTURBANCE, SAME = 1e-3, 1e-3
# Motions without end about a reference at rest.
HUNTING = ("limit_cycle", "irregular")
# No friction; what a law needs beside α₀ is given.
NOTHING = Friction(alpha0=0.0, alpha1=0.0)


class Axis(NamedTuple):
    """Inertia [kg m² or kg], friction in the units of torque and speed, and its law.

    ``load_friction`` is further friction per torque of the drive, as of a gear under load.
    Simulations have it, exact motions do not.
    """

    inertia: float
    friction: Friction
    law: str = "stribeck"
    load_friction: float = 0.0


class Pid(NamedTuple):
    """Gains k_p, k_i, k_d [N m/rad, N m/(rad s), N m s/rad] and filter time T [s]."""

    kp: float
    ki: float = 0.0
    kd: float = 0.0
    filter_time: float = 0.0

    @property
    def stiffness(self) -> float:
        """Torque per error [N m/rad] without integral action."""
        return self.kp

    @property
    def feedback(self) -> tuple[float, float, float]:
        """Torque per error, per speed and per integral of the error, without the filter."""
        return self.kp, self.kd, self.ki


class Cascade(NamedTuple):
    """Gain of the position k [1/s], and of the speed k_v [N m s/rad] and k_i [N m/rad]."""

    position: float
    speed: float
    integral: float = 0.0

    @property
    def stiffness(self) -> float:
        """Torque per error [N m/rad] without integral action."""
        return self.speed * self.position

    @property
    def feedback(self) -> tuple[float, float, float]:
        """Torque per error, per speed and per integral of the error, if the error starts at 0."""
        position, speed, integral = self
        return position * speed + integral, speed, position * integral


Controller = Pid | Cascade


class IntegralRule(NamedTuple):
    """What the integral does beside integrating while the reference rests."""

    dead_band: Annotated[float, About("measured error below which it pauses", "rad", 0.0)] = 0.0
    resets: Annotated[
        bool,
        About("its torque becomes that of the known load where the error changes its sign"),
    ] = False
    limit: Annotated[
        float,
        About(
            "limit of its torque beside the load while the position changes; 0: none", "N m", 0.0
        ),
    ] = 0.0


NO_RULE = IntegralRule()


def without_integral(controller: Controller) -> Controller:
    """The same gains without integral action."""
    if isinstance(controller, Cascade):
        return controller._replace(integral=0.0)
    return controller._replace(ki=0.0)


def servo_joint(axis: Axis, controller: Controller, speed: float = 0.0) -> Joint:
    """The closed loop while the reference moves at ``speed`` V [rad/s].

    The states are v, e, and as far as the controller has them the integral and the filter.

    Raises:
        ParameterError: A number is not finite, the inertia not above 0, or the law not analysed.
    """
    check_axis(axis, controller, speed)
    a, r = _closed(controller, axis.inertia, speed)
    b = np.zeros(len(a))
    b[0] = 1.0 / axis.inertia
    return joint(a, b, np.eye(len(a))[0], axis.friction, axis.law, r)


def check_axis(axis: Axis, controller: Controller, speed: float = 0.0) -> None:
    """Reject numbers of an axis that are not finite, and negative ones."""
    check_friction(axis.law, axis.friction)
    numbers = np.array([axis.inertia, speed, *controller])
    if not (np.all(np.isfinite(numbers)) and axis.inertia > 0.0):
        raise ParameterError(
            f"inertia must be above 0 and all numbers finite, given inertia {axis.inertia:g}"
        )
    if not 0.0 <= axis.load_friction < 1.0:
        raise ParameterError(
            f"load_friction must be at least 0 and below 1, given {axis.load_friction:g}"
        )
    if min(controller) < 0.0:
        raise ParameterError(f"gains and times must not be negative, given {tuple(controller)}")


def _closed(controller: Controller, inertia: float, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """A and r of the loop over (v, e, integral, filter); what has no effect is left out."""
    a, r = np.zeros((4, 4)), np.zeros(4)
    a[1, 0], r[1] = -1.0, speed
    if isinstance(controller, Cascade):
        kept = [0, 1, 2] if controller.integral else [0, 1]
        k, speed_gain, integral = controller
        a[0, :3] = -speed_gain, speed_gain * k, integral
        a[2, :2] = -1.0, k
    else:
        kp, ki, kd, filter_time = controller
        kept = [0, 1, 2] if ki else [0, 1]
        a[0, 1:3] = kp, ki
        a[2, 1] = 1.0
        if kd and filter_time:
            kept.append(3)
            a[0, 1] += kd / filter_time
            a[0, 3] = -kd / filter_time
            a[3, 1], a[3, 3] = 1.0 / filter_time, -1.0 / filter_time
        elif kd:
            a[0, 0] -= kd
            r[0] = kd * speed
    a[0] /= inertia
    r[0] /= inertia
    if not np.any(a[0, 1:]):
        kept = [0]
    return a[np.ix_(kept, kept)], r[kept]


def released(axis: Axis, controller: Controller, states: int) -> np.ndarray:
    """State x (n,) from which the axis is released: at rest, away from the reference."""
    x = np.zeros(states)
    if states > 1:
        x[1] = RELEASED_AT * highest_level(axis.friction) / max(controller.stiffness, 1e-9)
    if isinstance(controller, Pid) and controller.filter_time and controller.kd and states > 2:
        x[-1] = x[1]  # the filter has settled
    return x


def servo_cycle(axis: Axis, controller: Controller, speed: float = 0.0) -> JointCycle:
    """The final motion of the axis from rest: away from a reference at rest, on one that moves.

    ``peak_to_peak`` is that of the error. Raises what :func:`servo_joint` raises.
    """
    loop = servo_joint(axis, controller, speed)
    return final_motion(loop, next(_starts(axis, controller, loop, speed))[1])


def servo_motions(
    axis: Axis, controller: Controller, speed: float = 0.0, progress: Progress = unseen
) -> dict[str, JointCycle]:
    """The different final motions of an axis, by start; the first is that of :func:`servo_cycle`.

    The other start is a small disturbance, of rest on the reference or of steady motion with it.
    Raises what :func:`servo_joint` raises.
    """
    loop = servo_joint(axis, controller, speed)
    motions: dict[str, JointCycle] = {}
    for name, y in progress(_starts(axis, controller, loop, speed), 2):
        motion = final_motion(loop, y)
        if not any(_alike(motion, other) for other in motions.values()):
            motions[name] = motion
    return motions


def _starts(
    axis: Axis, controller: Controller, loop: Joint, speed: float
) -> Iterator[tuple[str, np.ndarray]]:
    """Starts by name, as states of the engine."""
    away = loop.state(released(axis, controller, len(loop.loop.b)))
    if speed == 0.0:
        yield "released", away
        yield "rest", DISTURBANCE * away
        return
    yield "rest", np.zeros_like(away)
    y = loop.steady(speed)
    y[W:BRISTLE] *= 1.0 + DISTURBANCE
    yield "steady motion", y


def _alike(one: JointCycle, other: JointCycle) -> bool:
    a, b = ((each.peak_to_peak, each.period_s) for each in (one, other))
    same = one.kind == "irregular" or np.allclose(a, b, rtol=SAME, atol=0.0, equal_nan=True)
    return bool(one.kind == other.kind and same)


def poles(axis: Axis, controller: Controller) -> np.ndarray:
    """Poles of the loop without dry friction [1/s]."""
    a, _ = _closed(controller, axis.inertia, 0.0)
    a[0, 0] -= axis.friction.viscous / axis.inertia
    return np.linalg.eigvals(a)
