"""Estimates the state from the measurement: the registry of methods and one sample of any of them.

Measurement and estimate are (5,): x, then the applied torque or the observed friction [V]
(:mod:`furuta_model.state`). To add a method, write its file in ``estimators/`` and add it here:
a row of :data:`METHODS`, its parameters, its design, and its branch in the functions at the end.
"""

from __future__ import annotations

from functools import lru_cache
from math import floor, nan, pi
from typing import Annotated, NamedTuple

import numpy as np

from furuta_control import readings
from furuta_control.estimators import kalman, lowpass, whole_circle
from furuta_control.estimators.kalman import Kalman, KalmanParameters
from furuta_control.estimators.lowpass import Lowpass, LowpassParameters
from furuta_control.estimators.rig import NominalRig
from furuta_control.estimators.whole_circle import WholeCircle
from furuta_control.readings import ReadingLimits, reading_limits
from furuta_model.compiled import compiled, inlined
from furuta_model.parameters import INLINE, About, ParameterError, shortened
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import (
    APPLIED_TORQUE,
    OBSERVED_FRICTION,
    PHI,
    PHI_DOT,
    RIGID_STATES,
    SIGNALS,
    THETA,
    THETA_DOT,
)


class Method(NamedTuple):
    """A method: whether it observes the friction, needs the applied torque, covers the circle.

    A method that does not cover the circle is for the pendulum near upright.
    """

    name: str
    meaning: str
    observes_friction: bool
    needs_applied_torque: bool
    covers_circle: bool = False


METHODS = (
    Method(
        "kalman",
        "fuses all sensors and the applied torque, and observes the friction",
        observes_friction=True,
        needs_applied_torque=True,
    ),
    Method(
        "lowpass",
        "the paper's filter on the potentiometer, arm as measured",
        observes_friction=False,
        needs_applied_torque=False,
    ),
    Method(
        "whole_circle",
        "kalman for any pendulum angle, with the nonlinear model",
        observes_friction=True,
        needs_applied_torque=True,
        covers_circle=True,
    ),
)
KALMAN, LOWPASS, WHOLE_CIRCLE = range(3)

_NAMES = tuple(method.name for method in METHODS)
_MEANINGS = "; ".join(f"{method.name}: {method.meaning}" for method in METHODS)
_OBSERVES_FRICTION = tuple(method.observes_friction for method in METHODS)

# The estimator's memory: the estimate, the running method (0: no estimate), the last readings.
RUNNING = SIGNALS
READINGS = RUNNING + 1
MEMORY = READINGS + readings.MEMORY
# Value of RUNNING while ideal measurements are the estimate.
UNFILTERED = -1.0
# Result of :func:`unusable_readings` without an estimate.
LOST = -1


class EstimatorParameters(NamedTuple):
    """Parameters of the node ``estimator``."""

    method: Annotated[str, About(_MEANINGS, choices=_NAMES)] = "kalman"
    model: FurutaPendulum = FurutaPendulum()
    model_viscous: Annotated[
        float,
        About(
            "viscous friction in the model; the observed friction does then not contain it",
            "V s/rad",
            0,
            100,
        ),
    ] = 0.0
    sensors: Sensors = Sensors()
    kalman: Annotated[KalmanParameters, INLINE] = KalmanParameters()
    lowpass: Annotated[LowpassParameters, INLINE] = LowpassParameters()
    sample_time: Annotated[
        float, About("time between measurements", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    def check(self) -> None:
        """Reject a rig for which no Kalman filter can be computed."""
        try:
            with np.errstate(all="ignore"):
                step = design_estimator(self).kalman.step
        except (np.linalg.LinAlgError, ValueError):
            step = np.full(1, nan)
        if not np.all(np.isfinite(step)):
            raise ParameterError(
                "no Kalman filter can be computed for this rig: model, sensors or process noise "
                f"are too extreme; given {shortened(self.model)}, {shortened(self.kalman)}"
            )

    @property
    def rig(self) -> NominalRig:
        """The nominal rig that every method uses."""
        return NominalRig(self.model, self.sensors, self.sample_time, self.model_viscous)

    @property
    def chosen(self) -> Method:
        """The method that the parameters select."""
        return METHODS[_NAMES.index(self.method)]


class EstimatorDesign(NamedTuple):
    """The estimator as :func:`estimate_state` uses it."""

    method: int
    ideal: bool
    readings: ReadingLimits
    sample_time: float
    lowpass: Lowpass
    kalman: Kalman
    whole_circle: WholeCircle


@lru_cache(maxsize=64)
def design_estimator(p: EstimatorParameters) -> EstimatorDesign:
    """The estimator that the parameters describe. Cached, because a design takes a millisecond."""
    method = _NAMES.index(p.method)
    return EstimatorDesign(
        method,
        p.sensors.ideal,
        reading_limits(p.rig, p.chosen.needs_applied_torque),
        p.sample_time,
        lowpass.design(p.rig, p.lowpass),
        kalman.design(p.rig, p.kalman),
        whole_circle.design(p.rig, p.kalman)
        if method == WHOLE_CIRCLE
        else whole_circle.unused(p.rig),
    )


@inlined
def estimate_state(
    memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """One sample: ``memory`` (MEMORY,) is updated, ``estimate`` (5,) written.

    Unusable readings in ``measurement`` are replaced (:mod:`furuta_control.readings`). Without an
    estimate ``estimate`` is what the usable readings say, NaN where they say nothing. After a
    change of method the new one starts from the estimate of the previous one. Ideal measurements
    are not filtered; the method is then used only to observe the friction, if it can. A method
    that covers the circle gives θ from −π to π.
    """
    if continues(memory, measurement, p):
        continue_estimate(memory, measurement, p, estimate)
        return
    if memory[RUNNING] != 0.0 and readings.all_usable(memory, READINGS, measurement, p.readings):
        readings.forget_unusable(memory, READINGS)
    elif not _repair(memory, measurement, p, estimate):
        return
    _filter(memory, measurement, p)
    _finish(memory, measurement, p, estimate)


@inlined
def continues(memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign) -> bool:
    """Whether the estimate runs with this method and every reading is usable: the usual sample."""
    running = UNFILTERED if _unfiltered(p) else p.method + 1.0
    return (memory[RUNNING] == running) & readings.all_usable(
        memory, READINGS, measurement, p.readings
    )


@inlined
def continue_estimate(
    memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """:func:`estimate_state` for a sample in which the estimate :func:`continues`."""
    readings.forget_unusable(memory, READINGS)
    if _unfiltered(p):
        _take_measurement(memory, measurement)
    else:
        _update(memory, measurement, p)
    _finish(memory, measurement, p, estimate)


@inlined
def _finish(
    memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """Remember the readings and write the estimate."""
    readings.remember(memory, READINGS, measurement)
    for i in range(SIGNALS):
        estimate[i] = memory[i]
    if p.ideal:
        for i in range(RIGID_STATES):
            estimate[i] = measurement[i]
        if p.method == WHOLE_CIRCLE:
            estimate[THETA] -= 2.0 * pi * floor(estimate[THETA] / (2.0 * pi) + 0.5)


@inlined
def _unfiltered(p: EstimatorDesign) -> bool:
    """Whether the ideal measurements are the estimate."""
    return p.ideal and not _OBSERVES_FRICTION[p.method]


@inlined
def _take_measurement(memory: np.ndarray, measurement: np.ndarray) -> None:
    for i in range(RIGID_STATES):
        memory[i] = measurement[i]
    memory[OBSERVED_FRICTION] = nan


@compiled
def pass_skipped(
    memory: np.ndarray,
    samples: int,
    measurement: np.ndarray,
    p: EstimatorDesign,
    estimate: np.ndarray,
) -> None:
    """Move the estimate over ``samples`` without readings, before ``measurement``.

    A plant or rig that is late leaves out measurements; it holds the torque meanwhile.
    """
    missing = np.empty(SIGNALS)
    for _ in range(samples):
        missing[:] = np.nan
        missing[APPLIED_TORQUE] = measurement[APPLIED_TORQUE]
        estimate_state(memory, missing, p, estimate)


def skipped_samples(interval: float, sample_time: float) -> int:
    """Number of samples left out in an ``interval`` between two measurements, in one unit."""
    return max(0, round(interval / sample_time) - 1)


@inlined
def unusable_readings(memory: np.ndarray) -> int:
    """Readings of the last sample that were replaced: a bit for each signal, -1 if lost."""
    if memory[RUNNING] == 0.0:
        return LOST
    bits = 0
    for i in range(SIGNALS):
        if memory[READINGS + readings.UNUSABLE + i] > 0.0:
            bits |= 1 << i
    return bits


@inlined
def restart(memory: np.ndarray) -> None:
    """Forget the estimate: the next measurement starts a new one."""
    memory[RUNNING] = 0.0


@inlined
def _filter(memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign) -> None:
    """Start the estimate or move it by one sample."""
    if _unfiltered(p):
        _take_measurement(memory, measurement)
        memory[RUNNING] = UNFILTERED
        return
    if memory[RUNNING] == 0.0:
        for i in range(THETA_DOT):
            memory[i] = measurement[i]
        memory[THETA_DOT] = memory[OBSERVED_FRICTION] = 0.0
        _begin(memory, measurement, p)
    else:
        if memory[RUNNING] != p.method + 1:
            if np.isnan(memory[OBSERVED_FRICTION]):
                memory[OBSERVED_FRICTION] = 0.0
            _begin(memory, measurement, p)
        _update(memory, measurement, p)
    memory[RUNNING] = p.method + 1


@compiled
def _repair(
    memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> bool:
    """Make the measurement usable or the estimate unknown; return whether there is one."""
    if memory[RUNNING] != 0.0:
        if p.readings.full_turn:
            seam = readings.cross_seam(memory, READINGS, measurement)
            memory[THETA] += seam
            memory[READINGS + THETA] += seam
        _predict(memory, measurement, p, estimate)
        if readings.replace_unusable(memory, READINGS, measurement, estimate, p.readings):
            return True
        restart(memory)
    if readings.can_start(measurement, p.readings):
        readings.forget_unusable(memory, READINGS)
        return True
    readings.unknown_state(measurement, estimate, p.readings)
    return False


@inlined
def _begin(memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign) -> None:
    """Initialise the method's memory; the estimate in ``memory`` is already set."""
    if p.method == LOWPASS:
        memory[READINGS + THETA] = measurement[THETA]
        lowpass.begin(memory, p.lowpass)


@inlined
def _update(memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign) -> None:
    if p.method == KALMAN:
        kalman.update(memory, measurement, p.kalman)
    elif p.method == LOWPASS:
        lowpass.update(memory, memory[READINGS + THETA], measurement, p.lowpass)
    elif p.method == WHOLE_CIRCLE:
        whole_circle.update(memory, measurement, p.whole_circle)


@inlined
def _predict(
    memory: np.ndarray, measurement: np.ndarray, p: EstimatorDesign, predicted: np.ndarray
) -> None:
    """Write the measurement (5,) that is expected: from the model, or at constant speeds."""
    dt = p.sample_time
    predicted[PHI] = memory[READINGS + PHI] + memory[PHI_DOT] * dt
    predicted[PHI_DOT] = memory[READINGS + PHI_DOT]
    predicted[THETA] = memory[READINGS + THETA] + memory[THETA_DOT] * dt
    predicted[THETA_DOT] = memory[READINGS + THETA_DOT]
    predicted[APPLIED_TORQUE] = memory[READINGS + APPLIED_TORQUE]
    if p.method == KALMAN:
        torque = measurement[APPLIED_TORQUE]
        if np.isnan(torque):
            torque = predicted[APPLIED_TORQUE]
        kalman.predict(memory, torque, p.kalman, predicted)
