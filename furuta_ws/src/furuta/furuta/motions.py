"""Simulates loops, computes their limit cycles and tunes them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from furuta.describing_functions.predicted_cycles import PredictedCycle, Prediction
from furuta.describing_functions.predicted_cycles import predict_cycles as predicted
from furuta.describing_functions.steady_rotation import steady_rotations
from furuta.limit_cycles import joint as joints
from furuta.limit_cycles import limit_cycle as cycles
from furuta.limit_cycles import periodic_orbit
from furuta.limit_cycles.joint import Joint, JointCycle, Units
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import LimitCycle, Trajectory
from furuta.loops import Part, checked_loop, ideal_loop, with_parts
from furuta.outcomes import Outcome, outcome
from furuta.studies.tuning_plan import TuningPlan
from furuta.transfer import joint_transfer, transfer
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError
from furuta_ros.time_stamps import MOST_SECONDS
from furuta_sim.simulation import closed_loop
from furuta_sim.simulation.closed_loop import Loop, Record

if TYPE_CHECKING:
    from furuta.studies.trials import TuningResult


def simulate(loop: Loop | None = None, seconds: float = 60.0, **parts: Part | None) -> Record:
    """Simulate a loop sample by sample, with its sensors and drive, from its initial state.

    Args:
        loop: The loop; by default that of the paper.
        seconds: Simulated time [s], at least one sample.
        parts: Functions of your own (docs/library.md): ``friction`` g(v, p) or a
            :class:`furuta.Law`, ``compensation`` F̂(memory, x, p), ``controller`` u(memory, x, F̂, p)
            [V], and ``estimator`` (memory, x, measurement, p), which changes x.

    Returns:
        Series of n samples: ``time`` (n,) [s], ``state`` (n, 4) [rad, rad/s], ``estimate`` (n, 5),
        ``friction``, ``friction_estimate`` and ``command`` (n,) [V]; ``measurement`` (n, 5), NaN
        where there is no sensor.

    Raises:
        ParameterError: ``seconds`` is not above 0, or above 1e6, a part cannot be compiled, or the
            series do not fit into memory.
    """
    check_seconds(seconds)
    try:
        return closed_loop.simulate(with_parts(loop, **parts), seconds)
    except MemoryError:
        reason = f"the series of {seconds:g} s do not fit into memory; measure() keeps none"
        raise ParameterError(reason) from None


def measure(
    loop: Loop | None = None, seconds: float = 60.0, settled: float = 0.5, **parts: Part | None
) -> Outcome:
    """Simulate a loop and measure its oscillation, without keeping the series.

    Args:
        loop: The loop; by default that of the paper.
        seconds: Simulated time [s], at least one sample.
        settled: Fraction of the run that is measured, at its end; above 0, at most 1.
        parts: As for :func:`simulate`.

    Returns:
        Peak to peak of arm and pendulum [rad], period [s], rms of command [V], and whether the
        pendulum fell.

    Raises:
        ParameterError: ``seconds`` or ``settled`` is outside its range, or a part cannot be
            compiled.
    """
    check_seconds(seconds)
    if not 0.0 < settled <= 1.0:
        raise ParameterError(f"settled must be above 0 and at most 1, given {settled:g}")
    return outcome(with_parts(loop, **parts), seconds, settled)


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
def limit_cycle(loop: Loop | IdealLoop | None = None, theta: float = 0.05) -> LimitCycle: ...


def limit_cycle(
    loop: Loop | IdealLoop | Joint | None = None,
    theta: float = 0.05,
    start: np.ndarray | None = None,
) -> LimitCycle | JointCycle:
    """The exact final motion of the ideal loop, with its sticking phases and stability.

    Args:
        loop: The loop; a sampled one is idealised by :func:`furuta.ideal_loop`. By default that of
            the paper. Or any linear loop that :func:`furuta.friction_joint` made.
        theta: Pendulum angle [rad] from which the loop is released at rest.
        start: State x (n,) from which a linear loop is released; by default the joint rests and
            all other states are displaced.

    Returns:
        The kind of motion, peak to peak [rad], period [s], Floquet multipliers.

    Raises:
        ParameterError: The motion cannot be followed, or its friction law is not analysed.
    """
    if isinstance(loop, Joint):
        return joints.joint_cycle(loop, start)
    return cycles.limit_cycle(_ideal(loop), cycles.state_at_rest(theta))


def trace_cycle(
    loop: Loop | IdealLoop | Joint | None, cycle: LimitCycle | JointCycle
) -> Trajectory:
    """One period of a limit cycle.

    Args:
        loop: The loop to which the cycle belongs; None is that of the paper.
        cycle: What :func:`limit_cycle` found.

    Returns:
        ``time`` (n,) [s], unevenly spaced; ``state`` (n, 5), x and the bristle [rad, rad/s], or
        position and x of a linear loop; ``control`` and ``friction`` (n,) [V, or unit of force].

    Raises:
        ParameterError: The motion is no oscillation with a finite period.
    """
    if isinstance(loop, Joint) and isinstance(cycle, JointCycle):
        return joints.trace_joint(loop, cycle)
    if isinstance(loop, Joint) or isinstance(cycle, JointCycle):
        raise ParameterError("the cycle does not belong to this kind of loop")
    if cycle.kind != "oscillation":
        raise ParameterError(f"only an oscillation can be traced, given a {cycle.kind} motion")
    return periodic_orbit.trace(_ideal(loop), cycle)


def predict_cycles(loop: Loop | IdealLoop | Joint | None = None) -> Prediction:
    """Limit cycles that the describing function predicts: 1 + G(jω)N(A, ω) = 0.

    Args:
        loop: The loop; by default that of the paper.

    Returns:
        ``cycles`` in order of amplitude, each with ω and A [rad/s], peak to peak [rad], period [s]
        and stability; the range of ω [rad/s] and A/ω [rad] that was searched. Of a linear loop in
        its own units.

    Raises:
        ParameterError: The friction law is not analysed.
    """
    if isinstance(loop, Joint):
        return _predict_joint(loop)
    ideal = _ideal(loop)
    return predicted(transfer(ideal.body, ideal.gains), ideal.law)


def _predict_joint(given: Joint) -> Prediction:
    """All solutions of 1 + G(jω)N(A, ω) = 0 with ω > 0, in the user's units."""
    loop, units = given.loop, given.units
    scaled = predicted(joint_transfer(loop.a, loop.b), loop.law)
    low, high = scaled.omega_range_rad_s
    least, largest = scaled.phi_amplitude_range_rad
    return scaled._replace(
        cycles=tuple(_in_units(cycle, units) for cycle in scaled.cycles),
        omega_range_rad_s=(low / units.time, high / units.time),
        phi_amplitude_range_rad=(least * units.position, largest * units.position),
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


def prediction_report(loop: IdealLoop, prediction: Prediction) -> dict[str, Any]:
    """The predicted cycles and rotations of a loop, and what was searched."""
    rotations = steady_rotations(loop.body, loop.gains, loop.law)
    return {
        "law": loop.law.name,
        "feedback": loop.gains,
        "stable_without_friction": transfer(loop.body, loop.gains).stable,
        "cycles": [cycle._asdict() for cycle in prediction.cycles],
        "rotations": [rotation._asdict() for rotation in rotations],
        "searched": {
            "omega_rad_s": prediction.omega_range_rad_s,
            "phi_amplitude_rad": prediction.phi_amplitude_range_rad,
        },
        "complete": prediction.complete,
    }


def tune(
    loop: Loop | None = None,
    seconds: float = 120.0,
    report: Callable[[str, float], None] | None = None,
    enough: float = 1.0,
) -> TuningResult:
    """Find the compensation with the smallest swing of the arm, by simulation.

    Args:
        loop: The loop; by default that of the paper. Its plant is the truth, which the tuning sees
            only through the estimates.
        seconds: Longest simulated time [s].
        report: Called with a message and the simulated time [s]; by default nothing is reported.
        enough: Swing that ends the search, in counts of the encoder.

    Returns:
        The trials ``before`` and ``after``, each with its ``compensation`` (parameters of
        estimator, friction observer and controller) and the arm's ``swing`` [rad]; all ``trials``;
        the ``parameters`` that changed, by node; whether there is a ``gain``.

    Raises:
        ParameterError: The time is too short, or the pendulum falls.
    """
    from furuta.studies.tuning import tune_simulated

    check_seconds(seconds)
    plan = TuningPlan(seconds, enough=enough)
    return tune_simulated(checked_loop(loop), plan, report or (lambda message, seconds: None))


def _ideal(loop: Loop | IdealLoop | None) -> IdealLoop:
    ideal = loop if isinstance(loop, IdealLoop) else ideal_loop(loop)
    ideal.check()
    return ideal


def check_seconds(seconds: float) -> None:
    """Reject a simulated time [s] that is out of its range."""
    if not 0.0 < seconds <= MOST_SECONDS:
        limits = f"above 0 and at most {MOST_SECONDS:g}"
        raise ParameterError(f"seconds must be {limits}, given {seconds:g}")
