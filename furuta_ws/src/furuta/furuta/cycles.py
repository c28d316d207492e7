"""Final motions of loops with friction: limit cycles, exact and predicted, branches and maps."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, overload

import numpy as np

from furuta.describing_functions.predicted_cycles import PredictedCycle
from furuta.describing_functions.predicted_cycles import predict_cycles as predicted
from furuta.limit_cycles import continuation
from furuta.limit_cycles import joint as joints
from furuta.limit_cycles import limit_cycle as cycles
from furuta.limit_cycles.joint import Joint, JointCycle, Units
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import LimitCycle
from furuta.loops import (
    checked_loop,
    ideal_loop,
    left_out,
    require_stabilising,
    require_varied,
    value_of,
)
from furuta.results.cycles import Branch, CycleMap, Prediction
from furuta.studies.feedback_map import map_feedbacks
from furuta.transfer import joint_transfer, transfer
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen
from furuta_model.state import RIGID_STATES
from furuta_sim.simulation.closed_loop import Loop

# Angle [rad] of the pendulum from which a loop is released at rest.
RELEASED_AT = 0.05

AnyLoop = Loop | IdealLoop | Joint


def friction_joint(
    system: Any, friction: Friction, law: str = "stribeck", offset: np.ndarray | None = None
) -> Joint:
    """Any linear loop with friction at one joint, for exact limit cycles.

    Args:
        system: The closed loop from a force on the joint [N, N m] to the joint's speed [m/s,
            rad/s]: a state space model or transfer function of python-control or scipy.signal, or
            matrices (A, b, c).
        friction: Its parameters, in the units of force and speed.
        law: coulomb, stiction, stribeck, lugre or dahl.
        offset: r (n,) of ẋ = A x + b f + r, for example of a reference that moves; by default 0.

    Raises:
        ParameterError: The system is not linear with one force and one speed, the law is not
            analysed, or a parameter of friction is outside its range.
    """
    return joints.joint(*joints.matrices(system), friction, law, offset)


@overload
def limit_cycle(loop: Joint, *, start: np.ndarray | None = None) -> JointCycle: ...


@overload
def limit_cycle(
    loop: Loop | IdealLoop | None = None,
    *,
    law: str | None = None,
    feedback: Iterable[float] | None = None,
    linear: bool = False,
    theta: float | None = None,
    start: np.ndarray | None = None,
) -> LimitCycle: ...


def limit_cycle(
    loop: AnyLoop | None = None,
    *,
    law: str | None = None,
    feedback: Iterable[float] | None = None,
    linear: bool = False,
    theta: float | None = None,
    start: np.ndarray | None = None,
) -> LimitCycle | JointCycle:
    """The exact final motion of a loop, with its sticking phases and stability.

    Args:
        loop: The loop, taken without sampling and saturation; by default that of the paper. Or any
            linear loop that :func:`furuta.friction_joint` made.
        law: coulomb, stiction, stribeck, lugre or dahl; by default that of the plant.
        feedback: l (4,) of u = l·x [V/rad, V s/rad, V/rad, V s/rad]; by default that of the
            controller. :func:`furuta.place_poles` gives L = −l.
        linear: Whether to take the linear pendulum instead of the nonlinear one.
        theta: Pendulum angle [rad] from which the loop is released at rest; by default 0.05.
        start: State from which it is released instead: x (4,); of a linear loop x (n,), and by
            default the joint rests and all other states are displaced.

    Raises:
        ParameterError: The motion cannot be followed, its friction law is not analysed, an argument
            does not belong to this kind of loop, or the feedback does not stabilise the pendulum.
    """
    if isinstance(loop, Joint):
        _reject(law=law, feedback=feedback, linear=linear or None, theta=theta)
        return joints.joint_cycle(loop, start)
    ideal = _ideal(loop, law, feedback, linear)
    cycle = cycles.limit_cycle(ideal, _start(theta, start))
    if cycle.kind == "unbounded":
        require_stabilising(ideal)
    return replace(cycle, loop=ideal, left_out=_left_out(loop))


def predict_cycles(
    loop: AnyLoop | None = None,
    *,
    law: str | None = None,
    feedback: Iterable[float] | None = None,
    linear: bool = False,
) -> Prediction:
    """Limit cycles that the describing function predicts: 1 + G(jω)N(A, ω) = 0.

    Args:
        loop: As of :func:`limit_cycle`.
        law: As there.
        feedback: As there.
        linear: As there.

    Raises:
        ParameterError: The friction law is not analysed.
    """
    if isinstance(loop, Joint):
        _reject(law=law, feedback=feedback, linear=linear or None)
        return _predict_joint(loop)
    ideal = _ideal(loop, law, feedback, linear)
    found = predicted(transfer(ideal.body, ideal.gains), ideal.law)
    return Prediction(**vars(found), loop=ideal, left_out=_left_out(loop))


def cycle_branch(
    loop: Loop | Callable[[float], Joint] | None,
    name: str,
    low: float,
    high: float,
    *,
    value: float | None = None,
    law: str | None = None,
    feedback: Iterable[float] | None = None,
    linear: bool = False,
    theta: float | None = None,
    start: np.ndarray | None = None,
) -> Branch:
    """The branch of limit cycles over a parameter, through folds and along unstable cycles.

    Args:
        loop: A loop, None for that of the paper; or a function that makes a linear loop with a
            friction joint for a value of the parameter.
        name: A parameter, as :func:`furuta.make_loop` takes it, or a gain l1 to l4 of u = l·x; of a
            function any name.
        low: Lower end of the range of the parameter.
        high: Its upper end.
        value: Where the branch begins, from a limit cycle that is the final motion there. By
            default it is the value that the loop has; of a function it must be given.
        law: As of :func:`limit_cycle`.
        feedback: As there.
        linear: As there.
        theta: As there.
        start: As there.

    Raises:
        ParameterError: The final motion at ``value`` is no limit cycle, or a loop is not possible.
    """
    if callable(loop):
        _reject(law=law, feedback=feedback, linear=linear or None, theta=theta)
        if value is None:
            raise ParameterError("value must be given, where the branch begins")
        motion, found = joints.branch(loop, low, high, value, start)
        return Branch(name, found, motion)
    given = checked_loop(loop)
    gains = None if feedback is None else list(feedback)
    require_varied(name)
    own = value_of(given, name, gains) if value is None else value
    ideal = ideal_loop(given, {} if value is None else {name: value}, law, gains, linear)
    cycle = cycles.limit_cycle(ideal, _start(theta, start))
    points = continuation.follow_branch(
        lambda each: ideal_loop(given, {name: each}, law, gains, linear), low, high, own, cycle
    )
    return Branch(name, points, replace(cycle, loop=ideal, left_out=left_out(given)))


def cycle_map(
    loop: Loop | None,
    values: Mapping[str, Iterable[float]],
    *,
    law: str | None = None,
    feedback: Iterable[float] | None = None,
    linear: bool = False,
    theta: float = RELEASED_AT,
    progress: Progress = unseen,
) -> CycleMap:
    """Final motions over a grid of two parameters, on all cores.

    Args:
        loop: The loop; None for that of the paper.
        values: Values of two parameters by name, as :func:`cycle_branch` takes it.
        law: As of :func:`limit_cycle`.
        feedback: As there.
        linear: As there.
        theta: As there.
        progress: Gets the motions and their number, and yields them.

    Raises:
        ParameterError: There are not two parameters, or no point is possible.
    """
    if len(values) != 2:
        raise ParameterError(f"a map needs two different parameters, given {', '.join(values)}")
    given = checked_loop(loop)
    gains = None if feedback is None else list(feedback)
    for name in values:
        require_varied(name)
    first, second = values
    firsts, seconds = (np.asarray(list(each), dtype=float) for each in values.values())
    mapped = map_feedbacks(
        lambda a, b: ideal_loop(given, {first: a, second: b}, law, gains, linear),
        firsts,
        seconds,
        theta,
    )
    points = list(progress(mapped, len(firsts) * len(seconds)))
    return CycleMap((first, second), (firsts, seconds), points, left_out(given))


def _ideal(
    loop: Loop | IdealLoop | None,
    law: str | None,
    feedback: Iterable[float] | None,
    linear: bool,
) -> IdealLoop:
    """The loop without sampling and saturation."""
    if isinstance(loop, IdealLoop):
        _reject(law=law, feedback=feedback, linear=linear or None)
        ideal = loop
    else:
        ideal = ideal_loop(checked_loop(loop), {}, law, feedback, linear)
    ideal.check()
    return ideal


def _left_out(loop: Loop | IdealLoop | None) -> tuple[str, ...]:
    return () if isinstance(loop, IdealLoop) else left_out(checked_loop(loop))


def _start(theta: float | None, start: np.ndarray | None) -> np.ndarray:
    """The engine's state at the start, with a relaxed bristle."""
    if start is None:
        return cycles.state_at_rest(RELEASED_AT if theta is None else theta)
    _reject(theta=theta)
    if np.shape(start) != (RIGID_STATES,):
        raise ParameterError(f"start must be x (4,), given the shape {np.shape(start)}")
    return np.append(start, 0.0)


def _reject(**arguments: Any) -> None:
    """Raise for arguments that would have no effect."""
    given = [name for name, value in arguments.items() if value is not None]
    if given:
        raise ParameterError(f"{', '.join(given)} cannot be combined with the other arguments")


def _predict_joint(given: Joint) -> Prediction:
    """All solutions of 1 + G(jω)N(A, ω) = 0 with ω > 0, in the user's units."""
    loop, units = given.loop, given.units
    scaled = predicted(joint_transfer(loop.a, loop.b), loop.law)
    low, high = scaled.omega_range_rad_s
    least, largest = scaled.phi_amplitude_range_rad
    return Prediction(
        cycles=tuple(_in_units(cycle, units) for cycle in scaled.cycles),
        omega_range_rad_s=(low / units.time, high / units.time),
        phi_amplitude_range_rad=(least * units.position, largest * units.position),
        complete=scaled.complete,
        loop=given,
    )


def _in_units(cycle: PredictedCycle, units: Units) -> PredictedCycle:
    return PredictedCycle(
        cycle.omega_rad_s / units.time,
        cycle.velocity_amplitude_rad_s * units.speed,
        cycle.phi_peak_to_peak_rad * units.position,
        cycle.period_s * units.time,
        cycle.stable,
        cycle.bias_v * units.force,
    )
