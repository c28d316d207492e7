"""Simulates an axis with encoder, controller and friction compensation."""

from typing import NamedTuple

import numpy as np

from furuta.axis.axis import Axis, Controller, check_axis, released
from furuta.axis.sampled_loop import CANDIDATES, LoopMemory, design_loop, paper_units, run_loop
from furuta_model.block import new_memory
from furuta_model.friction.laws import LAWS
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.recording import Recording

MOST_SAMPLES = 5_000_000


class AxisRecord(NamedTuple):
    """Series (n,) of an axis: time [s], reference, true and measured position [rad], torque [N m].

    A torque is that from its sample until the next one.
    """

    time: np.ndarray
    reference: np.ndarray
    position: np.ndarray
    measured: np.ndarray
    torque: np.ndarray

    @property
    def error(self) -> np.ndarray:
        """Reference minus true position (n,) [rad]."""
        return self.reference - self.position

    @property
    def recording(self) -> Recording:
        """What a user would have recorded, for :func:`furuta.identify_axis`."""
        measured = np.full((len(self.time), 4), np.nan)
        measured[:, PHI] = self.measured
        return Recording("simulation", self.time, measured, self.time, self.torque)

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """The recording as columns, for :func:`furuta.write_series`."""
        return {"time": self.time, "position": self.measured, "torque": self.torque}


def simulate_axis(
    axis: Axis,
    controller: Controller,
    *,
    seconds: float = 20.0,
    reference: float | np.ndarray = 0.0,
    compensation: str = "none",
    model: Axis | None = None,
    counts: int = 4096,
    sample_time: float = 1e-3,
) -> AxisRecord:
    """Simulate an axis with encoder, controller and friction compensation.

    Args:
        axis: The true axis.
        controller: Its gains; the filter of a PID is replaced by the observer's speed.
        seconds: Length of the simulation [s].
        reference: Its constant speed [rad/s], or its positions (n,) [rad] at all samples. With
            positions the axis starts at the first of them, otherwise as :func:`servo_cycle` has
            it: at rest away from a reference at rest, on one that moves.
        compensation: One of the compensators, or super_twisting.
        model: The axis as observer and compensator assume it; the true one by default.
        counts: Counts of the encoder per turn; 0 for a perfect sensor.
        sample_time: Time between samples [s].

    Raises:
        ParameterError: An argument is not allowed, or the loop has no poles.
    """
    choices = {"compensation": (compensation, CANDIDATES), "law": (axis.law, LAWS)}
    for name, (given, known) in choices.items():
        if given not in known:
            raise ParameterError(f"{name} must be one of {', '.join(known)}, given {given}")
    for each in (axis, model or axis):
        check_axis(each, controller)
    if not (counts >= 0 and 1e-6 <= sample_time <= 0.1 and seconds > 0.0):
        raise ParameterError(
            "counts must be at least 0, sample_time 1e-6 to 0.1 s and seconds above 0, given "
            f"{counts}, {sample_time:g} and {seconds:g}"
        )
    if np.ndim(reference):
        positions, offset = np.array(reference, dtype=float), 0.0
    else:
        time = sample_time * np.arange(min(seconds / sample_time, MOST_SAMPLES + 1))
        positions = reference * time
        offset = 0.0 if reference else float(released(axis, controller, 2)[1])
    usable = positions.ndim == 1 and np.all(np.isfinite(positions))
    if not (usable and 1 < len(positions) <= MOST_SAMPLES):
        raise ParameterError(
            f"a simulation must have 2 to {MOST_SAMPLES} samples, all finite: choose other "
            "seconds, sample_time or reference"
        )
    speeds = np.gradient(positions, sample_time)
    units = paper_units(axis, controller)
    count = 2.0 * np.pi / counts if counts else 0.0
    design = design_loop(axis, model or axis, controller, compensation, count, sample_time, units)
    memory = new_memory(LoopMemory)
    memory[0]["x"][PHI] = memory[0]["estimate"][0] = (positions[0] - offset) / units.position
    series = np.empty((3, len(positions)))
    run_loop(memory, positions / units.position, speeds / units.speed, design, series)
    if not np.all(np.isfinite(series)):
        raise ParameterError("the motion grows beyond all numbers: choose other gains or reference")
    position, measured, torque = series * [[units.position], [units.position], [units.force]]
    times: np.ndarray = sample_time * np.arange(len(positions))
    return AxisRecord(times, positions, position, measured, torque)
