"""Servo axes with friction: their final motion, what helps against it, and simulations."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from furuta.axis import axis as axes
from furuta.axis import simulation
from furuta.axis.axis import HUNTING, NO_RULE, Axis, Cascade, IntegralRule, Pid
from furuta.axis.compensations import compare_on_axis
from furuta.axis.cures import FEW, cures
from furuta.axis.draws import COMPARED, consequences
from furuta.axis.identified_axis import IdentifiedAxis
from furuta.axis.quiet_gains import quiet_gains
from furuta.limit_cycles.joint import JointCycle
from furuta.results.servo_axes import AxisRun, AxisStudy, Sampling, Study
from furuta_model.friction.laws import find_law
from furuta_model.friction.lugre import highest_level
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen

# Time between samples [s] and counts per turn if nothing is known of the drive.
SAMPLE_TIME, COUNTS = 1e-3, 4096
# Axes that a recording may come from, for which a change must end the hunting.
DRAWS_OF_GAINS = 20
# Chatter, relative to the level of friction, up to which a compensation suits the gears of a robot.
QUIET = 0.25


def servo_cycle(axis: Axis, controller: Pid | Cascade, speed: float = 0.0) -> JointCycle:
    """The final motion of an axis from rest: away from a reference at rest, on one that moves.

    Args:
        axis: The axis.
        controller: Its gains.
        speed: Speed of the reference [rad/s].

    Returns:
        The motion, of which ``peak_to_peak`` is that of the error [rad].

    Raises:
        ParameterError: A number is not finite, the inertia not above 0, or the law not analysed.
    """
    return axes.servo_cycle(axis, controller, speed)


def study_axis(
    axis: Axis | IdentifiedAxis,
    controller: Pid | Cascade,
    *,
    speed: float = 0.0,
    counts: int | None = None,
    sample_time: float | None = None,
    delay: float | None = None,
    tolerance: float | None = None,
    law: str | None = None,
    force: bool = False,
    prove: bool = False,
    progress: Progress = unseen,
) -> AxisStudy:
    """The final motions of an axis, and which change of its controller ends the hunting.

    The motions are exact. Then each compensation is simulated, which knows the axis while its
    friction is 0.8, 1 and 1.25 times as large or the torque a sample later, and rules of the
    integral are searched that need none. For an identified axis both are repeated for others that
    the recording may come from; its friction observer is a node of its own.

    Args:
        axis: The axis, what :func:`identify` returned, or what :func:`read_joint_file` has of it.
        controller: Its gains.
        speed: Speed of the reference [rad/s].
        counts: Counts of the encoder per turn, 0 for a perfect one; by default those of the
            recording, or 4096.
        sample_time: Time between samples [s]; by default that of the recording, or 1 ms.
        delay: Time after which a torque acts [s]; by default that of the recording, or 0.
        tolerance: Error [rad] that is allowed. Within it the largest dead band is searched, which
            rests soonest; by default the smallest.
        law: Friction law of an identified axis, as :meth:`furuta.results.AxisFit.axis` takes it.
        force: Whether to use an identified axis that is not usable.
        prove: Whether to prove the limit cycle in interval arithmetic, for the law stiction.
        progress: Gets, one after the other, starts, draws, compensations and changes, each with
            their number, and yields them.

    Raises:
        ParameterError: The identified axis is not usable, a number is not allowed, or the cycle
            cannot be proved.
    """
    fit, others = (axis, axis.draws()) if isinstance(axis, IdentifiedAxis) else (None, [])
    if fit is not None:
        fit.require(force)
        axis = fit.axis(law)
        known = fit.interval, max(fit.values.get("delay", 0.0), 0.0)
        turn = round(2.0 * math.pi / fit.resolution)
    elif law is not None or force:
        raise ParameterError("law and force belong to an identified axis")
    else:
        known, turn = (SAMPLE_TIME, 0.0), COUNTS
    if tolerance is not None and not tolerance > 0.0:
        raise ParameterError(f"tolerance must be above 0, given {tolerance:g}")
    allowed = tolerance or math.inf
    assert isinstance(axis, Axis)
    loop = Sampling(
        turn if counts is None else counts,
        known[0] if sample_time is None else sample_time,
        known[1] if delay is None else delay,
    )
    motions = axes.servo_motions(axis, controller, speed, progress)
    study = Study(axis, controller, speed, loop, motions, fit)
    cycle, options = next(iter(motions.values())), dict[str, Any](speed=speed, progress=progress)
    if fit is not None:
        study = replace(study, consequences=consequences(others, controller, **options))
        options["by_topic"] = True
    options["largest_chatter"] = QUIET * highest_level(axis.friction)
    if cycle.kind != "unbounded":
        study = replace(
            study,
            comparison=compare_on_axis(
                axis, controller, cycle=cycle, others=others[:COMPARED], **loop._asdict(), **options
            ),
        )
        may_hunt = study.consequences is not None and study.consequences.hunts_in > FEW
        if may_hunt or any(motion.kind in HUNTING for motion in motions.values()):
            options = loop._asdict() | {"others": others[:DRAWS_OF_GAINS], "progress": progress}
            if speed or find_law(axis.law).bristle:
                quiet = quiet_gains(axis, controller, speed=speed, **options)
                study = replace(study, quiet=quiet)
            else:
                found_cures = cures(axis, controller, tolerance=allowed, **options)
                study = replace(study, cures=found_cures, tolerance=allowed)
    if prove:
        from furuta.axis.proof import prove_cycle  # it needs python-flint

        if speed:
            raise ParameterError("a cycle is proved at a reference at rest only")
        study = replace(study, proof=prove_cycle(axis, controller))
    return AxisStudy(**vars(study))


def simulate_axis(
    axis: Axis,
    controller: Pid | Cascade,
    *,
    seconds: float = 20.0,
    reference: float | np.ndarray = 0.0,
    compensation: str = "none",
    model: Axis | None = None,
    counts: int = COUNTS,
    sample_time: float = SAMPLE_TIME,
    delay: float = 0.0,
    by_topic: bool = False,
    rule: IntegralRule = NO_RULE,
) -> AxisRun:
    """Simulate an axis with encoder, controller and friction compensation.

    Args:
        axis: The true axis.
        controller: Its gains; the filter of a PID is replaced by the observer's speed.
        seconds: Length of the simulation [s].
        reference: Its constant speed [rad/s], or its positions (n,) [rad] at all samples. With
            positions the axis starts at the first of them, otherwise as :func:`servo_cycle` has
            it: at rest away from a reference at rest, on one that moves.
        compensation: One of the compensators.
        model: The axis as observer and compensator assume it; the true one by default.
        counts: Counts of the encoder per turn; 0 for a perfect sensor.
        sample_time: Time between samples [s].
        delay: Time after which a torque acts [s], rounded to samples.
        by_topic: The friction estimate comes a sample late, as from a node of its own.
        rule: What the integral of the controller does while the reference rests.

    Raises:
        ParameterError: An argument is not allowed, or the loop has no poles.
    """
    run = simulation.simulate_axis(
        axis,
        controller,
        seconds=seconds,
        reference=reference,
        compensation=compensation,
        model=model,
        counts=counts,
        sample_time=sample_time,
        delay=delay,
        by_topic=by_topic,
        rule=rule,
    )
    return AxisRun(**vars(run))
