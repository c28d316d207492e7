r"""A single axis with friction, from a recording of its position and of its drive's torque.

.. math:: J\dot v = τ - σ_2 v - d|v| - F - f_0 - f_1 t

The equation is that of the arm of a Furuta pendulum whose pendulum hardly couples to it. So an axis
is fitted as such an arm: in units in which it moves at about 1 rad/s with a Coulomb level of
0.05 V, so that the priors of the unknowns are weak. While the axis sticks it hangs on a stiff
bristle. The offset f₀ + f₁t of the torque is fitted, so that it does not bias the rest, but it
belongs to the recording, not to the axis.
"""

from typing import Any, NamedTuple

import numpy as np

from furuta_identification.fitting.swinging import fit_growing_segments
from furuta_identification.regression.equations import arm_equation
from furuta_identification.regression.speeds import with_speeds
from furuta_identification.regression.windows import Windows
from furuta_identification.shooting.optimisation import (
    FINE,
    Optimum,
    fit_percent,
    noise_of,
    optimise,
    quantisation_step,
    residual_scale,
)
from furuta_identification.shooting.segments import cut_into_segments
from furuta_identification.shooting.shooting import Shooting
from furuta_identification.shooting.unknowns import LOGARITHMIC, ParameterValues
from furuta_identification.uncertainty.covariance import covariance_and_information
from furuta_identification.uncertainty.identifiability import LARGEST_RELATIVE_ERROR, identifiable
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import excerpts_of

# Coulomb level [V] and root mean square of the speed [rad/s] in the units of the fit.
LEVEL, SPEED = 0.05, 1.0
# The pendulum that hardly couples: it hangs, and neither centrifugal force nor anything else moves
# it [V s²/rad, V/rad, V s/rad].
PENDULUM = {"beta": 1.0, "gamma": 1e-9, "delta": 100.0, "pendulum_viscous": 10.0}
# Natural frequency [rad/s] of the stuck axis on its bristle; its damping ratio is 0.5.
STUCK = 200.0
# Fewest counts of the sensor over which the axis must move, and smallest level that is expected, as
# a part of the usual torque.
COUNTS, SMALLEST_LEVEL = 8.0, 0.02
# Samples from which excerpts are fitted; fit [%] of a free run below which segments of a length [s]
# are fitted instead.
MOST_SAMPLES = 30_000
FREE_RUN, SEGMENT = 80.0, 1.5
OFFSET = ["offset", "drift"]
FIRST = ["arm_inertia", "viscous", "coulomb", "viscous_difference", *OFFSET]
FURTHER = ["asymmetry", "alpha1", "stribeck_velocity"]
# What is reported: the unknown by the name of the result, and the powers of the units of torque and
# position in it.
REPORTED = {
    "inertia": ("arm_inertia", 1, -1),
    "alpha0": ("coulomb", 1, 0),
    "alpha1": ("alpha1", 1, 0),
    "stribeck_velocity": ("stribeck_velocity", 0, 1),
    "viscous": ("viscous", 1, -1),
    "viscous_difference": ("viscous_difference", 1, -1),
    "asymmetry": ("asymmetry", 0, 0),
    "offset": ("offset", 1, 0),
    "drift": ("drift", 1, 0),
}


class AxisFit(NamedTuple):
    """Values and standard errors by name, in the units of position and torque; and the fit.

    A value that the recording does not determine is absent. ``count`` is the smallest change of the
    position. ``units`` are the position and the torque that count as one in ``optimum``, whose
    window is infinite if a free run was fitted.
    """

    values: dict[str, float]
    standard_errors: dict[str, float]
    count: float
    findings: list[str]
    units: tuple[float, float]
    optimum: Optimum

    def error(self, recording: Recording, own_offset: bool = False) -> float:
        """Root mean square error of the free run over a recording, in the unit of position.

        The model gets the torque, but the position only at the start. The drift is left out; the
        offset is that of the fit, or the recording's ``own_offset``.
        """
        ready, _ = _prepared(recording, *self.units)
        values, scale = self.optimum.values.changed(["drift"], [0.0]), self.optimum.scale
        if own_offset:
            values = optimise([ready], ["offset"], values, np.inf, scale, robust=False).values
        return self.units[0] * _free_run_error([ready], values, scale)

    def report(self) -> dict[str, Any]:
        """Everything by name, as the command line prints it."""
        missing = [name for name in REPORTED if name not in self.values]
        runs = self.optimum.recordings
        with_drift = _free_run_error(runs, self.optimum.values, self.optimum.scale)
        return {
            **self.values,
            "standard_errors": self.standard_errors,
            "undetermined": missing,
            "count": self.count,
            "window_s": self.optimum.window,
            "free_run_error": self.units[0] * with_drift,
            "findings": self.findings,
        }


def identify_axis(recording: Recording) -> AxisFit:
    """Fit an axis; the arm of the ``recording`` is the axis, its command the torque.

    Raises:
        ParameterError: The axis hardly moves, or the recording does not determine its inertia.
    """
    _refuse_rest(recording)
    units, start = _first_estimate(recording)
    ready, findings = _prepared(recording, *units)
    excerpts, remarks = excerpts_of(ready, MOST_SAMPLES)
    scale = np.median([noise_of(excerpt) for excerpt in excerpts], axis=0)
    optimum = fit_growing_segments(excerpts, FIRST, start, SEGMENT, scale)
    optimum = _with_further_unknowns(optimum)
    if len(excerpts) == 1:
        free = optimise(excerpts, OFFSET, optimum.values, np.inf, optimum.scale, robust=True)
        free = optimise(excerpts, optimum.names, free.values, np.inf, residual_scale(free), True)
        if fit_percent(*(y[:, PHI] for y in (ready.measured, free.predictions[0][1]))) >= FREE_RUN:
            optimum = free
    optimum = _with_further_unknowns(optimum, FINE)
    count = quantisation_step(recording.measured[:, PHI])
    return AxisFit(*_reported(optimum, units), count, [*findings, *remarks], units, optimum)


def _with_further_unknowns(optimum: Optimum, tolerance: float = 1e-4) -> Optimum:
    """The fit with those further unknowns that the recording determines."""
    further = [name for name in FURTHER if name not in optimum.names]
    names = [*optimum.names, *identifiable(optimum, further)]
    return optimum.refitted(names, optimum.values, tolerance)


def _prepared(recording: Recording, position: float, torque: float) -> tuple[Recording, list[str]]:
    """The usable part in these units, with the pendulum at rest, and time 0 in its middle."""
    measured = np.zeros((len(recording.time), 4))
    measured[:, PHI] = recording.measured[:, PHI] / position
    measured[:, PHI_DOT], measured[:, THETA] = np.nan, np.pi
    middle = 0.5 * (recording.time[0] + recording.time[-1])
    return cleaned(
        recording._replace(
            time=recording.time - middle,
            measured=measured,
            command_time=recording.command_time - middle,
            command=recording.command / torque,
        )
    )


def _first_estimate(recording: Recording) -> tuple[tuple[float, float], ParameterValues]:
    """Units of position and torque for the fit, and a first estimate in them, by regression."""
    size = float(np.sqrt(np.mean(recording.command**2))) or 1.0
    moving = with_speeds(_prepared(recording, 1.0, size)[0], 0.0)
    position = float(np.sqrt(np.mean(moving.measured[:, PHI_DOT] ** 2))) / SPEED
    moving = with_speeds(_prepared(recording, position, size)[0], 0.0)
    regression = arm_equation(moving, Windows(moving.time), 0.0, 0.0)
    inertia, _, viscous, forward, backward = regression.coefficients
    if not inertia > 0.0:
        raise ParameterError(
            f"{recording.name}: the torque does not accelerate the axis; change its sign, or "
            "record a motion that accelerates"
        )
    level = max(0.5 * (forward + backward), SMALLEST_LEVEL)
    scale = LEVEL / level
    stiffness = scale * inertia * STUCK**2
    start = ParameterValues.of(
        arm_inertia=scale * inertia,
        **PENDULUM,
        viscous=scale * max(viscous, 0.0),
        coulomb=LEVEL,
        offset=scale * 0.5 * (forward - backward),
        sigma0=stiffness,
        sigma1=stiffness / STUCK,
    )
    return (position, size / scale), start


def _refuse_rest(recording: Recording) -> None:
    """Raise if the axis hardly moves."""
    travel, count = (f(recording.measured[:, PHI]) for f in (np.ptp, quantisation_step))
    if not travel >= COUNTS * count > 0.0:
        raise ParameterError(
            f"{recording.name}: the axis moves by {travel:g}, which is less than {COUNTS:g} counts "
            f"of {count:g} of its sensor; record a larger motion"
        )


def _free_run_error(
    recordings: list[Recording], values: ParameterValues, scale: np.ndarray
) -> float:
    """Root mean square error of the position over free runs, in the units of the fit."""
    errors = [r.measured[:, PHI] - y[:, PHI] for r, y in _free_runs(recordings, values, scale)]
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def _free_runs(
    recordings: list[Recording], values: ParameterValues, scale: np.ndarray
) -> list[tuple[Recording, np.ndarray]]:
    """Each recording, and its free run (n, 4)."""
    parts = [cut_into_segments(recording, np.inf, scale, values) for recording in recordings]
    predicted = Shooting(parts, [], values).predictions(np.zeros(0))
    return list(zip(recordings, predicted, strict=True))


def _reported(
    optimum: Optimum, units: tuple[float, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """Values and standard errors by name, those that the recording determines."""
    covariance, information = covariance_and_information(optimum, {})
    position, torque = units
    values, errors = {}, {}
    for name, (unknown, of_torque, of_position) in REPORTED.items():
        if unknown not in optimum.names:
            continue
        index = optimum.names.index(unknown)
        value, error = optimum.values[unknown], float(np.sqrt(covariance[index, index]))
        if unknown in LOGARITHMIC:
            error *= value
        certain = unknown not in LOGARITHMIC or error < LARGEST_RELATIVE_ERROR * value
        if information[index, index] > 0.0 and certain:
            unit = torque**of_torque * position**of_position
            values[name], errors[name] = unit * value, unit * error
    if "inertia" not in values:
        raise ParameterError(
            f"{optimum.recordings[0].name}: the recording does not determine the inertia: the "
            "motion does not depend on it; record one that accelerates"
        )
    return values, errors
