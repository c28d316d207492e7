"""Estimates the state from the measurement: the methods, and one sample of the chosen one.

Measurement and estimate are (5,): x, then the applied torque [V] (:mod:`furuta_model.state`). A
method gets the torque behind the delay and lag that are known of the drive. To add a method, write
its file in ``estimators/`` and name it here: in :data:`METHODS`, in :func:`update`, and where it
has parameters, memory or design.
"""

from dataclasses import dataclass, field
from math import floor, nan, pi
from typing import Annotated, Final, NamedTuple

import numpy as np

from furuta_control import readings
from furuta_control.estimators import kalman, lowpass, own, whole_circle
from furuta_control.estimators.kalman import Kalman
from furuta_control.estimators.lowpass import Lowpass, LowpassParameters
from furuta_control.estimators.method import Method, NominalRig
from furuta_control.estimators.own import OwnEstimation
from furuta_control.estimators.whole_circle import WholeCircle
from furuta_control.readings import ReadingLimits, ReadingMemory, reading_limits
from furuta_model.block import zeros
from furuta_model.compiled import compiled, inlined
from furuta_model.late_drive import (
    DriveMemory,
    LateDrive,
    SampledDrive,
    acting_torque,
    assume_held,
    design_drive,
)
from furuta_model.linear import KalmanParameters
from furuta_model.own_functions import ADDRESS, OwnMemory, forget_own, kind_and_address
from furuta_model.parameters import INLINE, SELECTS, About, ParameterError, designed_once, shortened
from furuta_model.pendulum import FurutaPendulum
from furuta_model.sensors import Sensors
from furuta_model.state import (
    APPLIED_TORQUE,
    LARGEST_VALUE,
    OBSERVED_FRICTION,
    PHI,
    PHI_DOT,
    RIGID_STATES,
    SIGNALS,
    THETA,
    THETA_DOT,
)

METHODS = (
    Method(
        "kalman",
        "Kalman filter on all sensors and the applied torque",
        needs_applied_torque=True,
    ),
    Method("lowpass", "the paper's filter on the potentiometer, with the arm as measured"),
    Method(
        "whole_circle",
        "Kalman filter with the nonlinear model, for any pendulum angle",
        needs_applied_torque=True,
        covers_circle=True,
    ),
)
METHOD_NAMES = tuple(method.name for method in METHODS)
# Kinds: places in the list, and one of the user's own.
KALMAN = METHOD_NAMES.index("kalman")
LOWPASS = METHOD_NAMES.index("lowpass")
WHOLE_CIRCLE = METHOD_NAMES.index("whole_circle")
OWN = len(METHODS)
_MEANINGS = "; ".join(f"{method.name}: {method.meaning}" for method in METHODS)
# Values of ``running`` in the estimator's memory that are no method.
NOT_RUNNING, UNFILTERED = 0, -1
# Result of :func:`unusable_readings` without an estimate.
LOST: Final = 1 << SIGNALS


class EstimatorParameters(NamedTuple):
    """Parameters of the node ``estimator``."""

    method: Annotated[str, About(_MEANINGS, choices=METHOD_NAMES, own=True)] = "kalman"
    model: FurutaPendulum = FurutaPendulum()
    model_viscous: Annotated[
        float,
        About(
            "viscous friction of the arm in the model",
            "V s/rad",
            0,
            100,
        ),
    ] = 0.0
    sensors: Sensors = Sensors()
    kalman: Annotated[KalmanParameters, INLINE] = KalmanParameters()
    lowpass: Annotated[LowpassParameters, INLINE] = LowpassParameters()
    drive: LateDrive = LateDrive()
    sample_time: Annotated[
        float, About("time between measurements", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001

    def check(self) -> None:
        """Reject a rig for which no filter can be computed, or an unstable one."""
        try:
            with np.errstate(all="ignore"):
                step = design_estimator(self).kalman.step
        except ParameterError:
            raise
        except (np.linalg.LinAlgError, ValueError):
            step = np.full(1, nan)
        if not np.all(np.isfinite(step)):
            raise ParameterError(
                "no Kalman filter can be computed for this rig: model, sensors or process noise "
                f"are too extreme; given {shortened(self.model)}, {shortened(self.kalman)}"
            )
        largest = whole_circle.largest_viscous(self.rig)
        if self.chosen.covers_circle and self.model_viscous > largest:
            raise ParameterError(
                f"method {self.method} needs a model_viscous of at most {largest:.3g} V s/rad for "
                f"this model and sample time; given {self.model_viscous:g}"
            )

    @property
    def rig(self) -> NominalRig:
        """The nominal rig that every method uses."""
        return NominalRig(self.model, self.sensors, self.sample_time, self.model_viscous)

    @property
    def chosen(self) -> Method:
        """The method that the parameters select."""
        if self.method in METHOD_NAMES:
            return METHODS[METHOD_NAMES.index(self.method)]
        return Method(self.method, "own")


class EstimatorDesign(NamedTuple):
    """The estimator as :func:`estimate_state` uses it; ``function`` is that of an own method.

    ``filtered``: whether the estimate is more than the ideal measurement. With
    ``covers_circle`` θ is from −π to π.
    """

    method: Annotated[int, SELECTS]
    function: int
    filtered: Annotated[bool, SELECTS]
    covers_circle: Annotated[bool, SELECTS]
    ideal: bool
    is_late: Annotated[bool, SELECTS]
    readings: ReadingLimits
    sample_time: float
    kalman: Kalman
    lowpass: Lowpass
    whole_circle: WholeCircle
    own: OwnEstimation
    drive: SampledDrive


@dataclass
class EstimatorMemory:
    """What the estimator remembers.

    Attributes:
        estimate: The estimate (5,) of x and of the friction that the method observes.
        running: The running method, an index of :data:`METHODS` plus 1; :data:`NOT_RUNNING`
            without an estimate, :data:`UNFILTERED` while ideal measurements are the estimate.
        readings: Memory of the check of readings.
        own: Memory of an own method.
        drive: What the drive has been given.
    """

    estimate: np.ndarray = zeros(SIGNALS)
    running: int = NOT_RUNNING
    readings: ReadingMemory = field(default_factory=ReadingMemory)
    own: OwnMemory = field(default_factory=OwnMemory)
    drive: DriveMemory = field(default_factory=DriveMemory)


@designed_once
def design_estimator(p: EstimatorParameters) -> EstimatorDesign:
    """The estimator that the parameters describe."""
    chosen, rig = p.chosen, p.rig
    method, function = kind_and_address(p.method, METHOD_NAMES, OwnEstimation, ADDRESS)
    return EstimatorDesign(
        method=method,
        function=function,
        filtered=not p.sensors.ideal or method == OWN,
        covers_circle=chosen.covers_circle,
        ideal=p.sensors.ideal,
        is_late=p.drive.is_late,
        readings=reading_limits(rig, chosen.needs_applied_torque),
        sample_time=p.sample_time,
        kalman=kalman.design(rig, p.kalman),
        lowpass=lowpass.design(p.lowpass, p.sample_time),
        whole_circle=whole_circle.design(rig, p.kalman, is_chosen=method == WHOLE_CIRCLE),
        own=OwnEstimation(p.model, p.model_viscous, p.sample_time),
        drive=design_drive(p.drive, p.sample_time),
    )


@inlined
def estimate_state(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """One sample: ``memory`` is updated, ``estimate`` (5,) written.

    Unusable readings in ``measurement`` are replaced (:mod:`furuta_control.readings`). Without an
    estimate ``estimate`` is what the usable readings say, NaN where they say nothing. After a
    change of method the new one starts from the estimate of the previous one. Ideal measurements
    are not filtered. A method that covers the circle gives θ from −π to π.
    """
    if not is_bounded(memory):
        restart(memory)
    running = memory.running != NOT_RUNNING
    if running and readings.all_usable(memory.readings, measurement, p.readings):
        readings.forget_unusable(memory.readings)
    elif not _repair(memory, measurement, p, estimate):
        return
    if p.filtered and p.is_late:
        voltage = measurement[APPLIED_TORQUE]
        measurement[APPLIED_TORQUE] = acting_torque(memory.drive, voltage, p.drive)
        _filter(memory, measurement, p)
        measurement[APPLIED_TORQUE] = voltage
    elif p.filtered:
        _filter(memory, measurement, p)
    else:
        take_measurement(memory, measurement)
    finish(memory, measurement, p, estimate)


@inlined
def is_bounded(memory: EstimatorMemory) -> bool:
    """Whether the estimate can go on: a nonlinear one escapes after speeds that no rig reaches.

    An own method that has failed leaves NaN.
    """
    x = memory.estimate
    return abs(x[PHI_DOT]) + abs(x[THETA]) + abs(x[THETA_DOT]) <= LARGEST_VALUE


@inlined
def take_measurement(memory: EstimatorMemory, measurement: np.ndarray) -> None:
    """Take the ideal measurement as the estimate."""
    for i in range(RIGID_STATES):
        memory.estimate[i] = measurement[i]
    memory.estimate[OBSERVED_FRICTION] = nan
    memory.running = UNFILTERED


@inlined
def _filter(memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign) -> None:
    """Start the estimate or move it by one sample."""
    x = memory.estimate
    if memory.running == NOT_RUNNING:
        for i in range(THETA_DOT):
            x[i] = measurement[i]
        x[THETA_DOT] = x[OBSERVED_FRICTION] = 0.0
        _begin(memory, measurement, p)
    else:
        if memory.running != p.method + 1:
            if np.isnan(x[OBSERVED_FRICTION]):
                x[OBSERVED_FRICTION] = 0.0
            _begin(memory, measurement, p)
        update(memory, measurement, p)
    memory.running = p.method + 1


@inlined
def _begin(memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign) -> None:
    """Let the method start from the estimate."""
    forget_own(memory.own)
    if p.method == LOWPASS:
        lowpass.begin(memory.estimate, memory.readings.last, measurement, p.lowpass)


@inlined
def update(memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign) -> None:
    """Move the estimate by one sample with a ``measurement``."""
    x = memory.estimate
    if p.method == KALMAN:
        kalman.update(x, measurement, p.kalman)
    elif p.method == LOWPASS:
        lowpass.update(x, memory.readings.last, measurement, p.lowpass)
    elif p.method == WHOLE_CIRCLE:
        whole_circle.update(x, measurement, p.whole_circle)
    elif p.method == OWN:
        own.update(memory.own, x, measurement, p.function, p.own)
    else:
        x[PHI_DOT] = nan


@inlined
def finish(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> None:
    """Remember the readings and write the estimate."""
    readings.remember(memory.readings, measurement)
    for i in range(RIGID_STATES):
        estimate[i] = memory.estimate[i]
    estimate[APPLIED_TORQUE] = measurement[APPLIED_TORQUE]
    if p.ideal:
        for i in range(RIGID_STATES):
            estimate[i] = measurement[i]
        if p.covers_circle:
            estimate[THETA] -= 2.0 * pi * floor(estimate[THETA] / (2.0 * pi) + 0.5)


@compiled
def pass_skipped(
    memory: EstimatorMemory,
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


@inlined
def skipped_samples(interval: float, sample_time: float) -> int:
    """Number of samples left out in an ``interval`` between two measurements, in one unit."""
    return max(0, round(interval / sample_time) - 1)


@inlined
def unusable_readings(memory: EstimatorMemory) -> int:
    """Readings of the last sample that were replaced: a bit for each signal, or LOST."""
    if memory.running == NOT_RUNNING:
        return LOST
    bits = 0
    for i in range(SIGNALS):
        if memory.readings.unusable[i] > 0.0:
            bits |= 1 << i
    return bits


@inlined
def restart(memory: EstimatorMemory) -> None:
    """Forget the estimate: the next measurement starts a new one."""
    memory.running = NOT_RUNNING
    assume_held(memory.drive, 0.0)


@compiled
def _repair(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign, estimate: np.ndarray
) -> bool:
    """Make the measurement usable or the estimate unknown; return whether there is one."""
    checked = memory.readings
    if memory.running != NOT_RUNNING:
        if p.readings.full_turn:
            seam = readings.cross_seam(checked, measurement)
            memory.estimate[THETA] += seam
            checked.last[THETA] += seam
        _predict(memory, measurement, p, estimate)
        if readings.replace_unusable(checked, measurement, estimate, p.readings):
            return True
        restart(memory)
    if readings.can_start(measurement, p.readings):
        readings.forget_unusable(checked)
        return True
    readings.unknown_state(measurement, estimate, p.readings)
    return False


@inlined
def _predict(
    memory: EstimatorMemory, measurement: np.ndarray, p: EstimatorDesign, predicted: np.ndarray
) -> None:
    """Write the measurement (5,) that is expected: at constant speeds, or by the method."""
    last, x, dt = memory.readings.last, memory.estimate, p.sample_time
    predicted[PHI] = last[PHI] + x[PHI_DOT] * dt
    predicted[PHI_DOT] = last[PHI_DOT]
    predicted[THETA] = last[THETA] + x[THETA_DOT] * dt
    predicted[THETA_DOT] = last[THETA_DOT]
    predicted[APPLIED_TORQUE] = last[APPLIED_TORQUE]
    torque = measurement[APPLIED_TORQUE]
    if np.isnan(torque):
        torque = predicted[APPLIED_TORQUE]
    if p.is_late:
        torque = memory.drive.torque
    if p.method == KALMAN:
        kalman.predict(x, torque, p.kalman, predicted)
