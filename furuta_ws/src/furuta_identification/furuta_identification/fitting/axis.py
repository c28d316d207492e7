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
from furuta_identification.model import Model
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
from furuta_identification.shooting.unknowns import LOGARITHMIC, ParameterValues
from furuta_identification.uncertainty.covariance import covariance_and_information
from furuta_identification.uncertainty.identifiability import identifiable, undetermined
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording, findings_of
from furuta_recordings.splitting import excerpts_of

# Coulomb level [V] and root mean square of the speed [rad/s] in the units of the fit; what stiction
# is first expected above that level [V].
LEVEL, SPEED, STICTION = 0.05, 1.0, 0.01
# The pendulum that hardly couples: it hangs, and neither centrifugal force nor anything else moves
# it [V s²/rad, V/rad, V s/rad].
PENDULUM = {"beta": 1.0, "gamma": 1e-9, "delta": 100.0, "pendulum_viscous": 10.0}
# Natural frequency [rad/s] and damping ratio of the stuck axis on its bristle. A softer bristle or
# a stronger damper would hide how friction drops after breakaway.
STUCK, DAMPING = 1000.0, 0.025
# Fewest counts of the sensor over which the axis must move, and smallest level that is expected, as
# a part of the usual torque.
COUNTS, SMALLEST_LEVEL = 8.0, 0.02
# Samples from which excerpts are fitted; fit [%] of a free run below which segments of a length [s]
# are fitted instead.
MOST_SAMPLES = 30_000
SMALLEST_FIT, SEGMENT = 80.0, 1.5
OFFSET = ["offset", "drift"]
FRICTION = ["viscous", "coulomb", "alpha1", "stribeck_velocity", "viscous_difference"]
UNKNOWNS = ["arm_inertia", *FRICTION, *OFFSET]
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
    """Values and standard errors by name, in the units of position and torque.

    What the recording does not determine is only in ``undetermined``, with the reason.
    ``resolution`` is the smallest change of the position. ``model`` is in its own units: the
    ``units`` are the position and the torque that are one in it.
    """

    values: dict[str, float]
    standard_errors: dict[str, float]
    undetermined: dict[str, str]
    resolution: float
    units: tuple[float, float]
    model: Model

    def error(self, recording: Recording, own_offset: bool = False) -> float:
        """Root mean square error of the free run over a recording, in the unit of position.

        The model gets the torque, but the position only at the start. The drift is left out; the
        offset is that of the fit, or the recording's ``own_offset``.
        """
        ready = _prepared(recording, *self.units)
        values = self.model.values.changed(["drift"], [0.0])
        if own_offset:
            fit = optimise([ready], ["offset"], values, np.inf, self.model.scale, robust=False)
            values = fit.values
        free = self.model._replace(values=values, window=np.inf)
        return self.units[0] * _errors(free, [ready])

    def report(self) -> dict[str, Any]:
        """Everything by name, as the command line prints it."""
        own = self.units[0] * _errors(self.model, self.model.recordings)
        return {
            **self.values,
            "standard_errors": self.standard_errors,
            "undetermined": self.undetermined,
            "resolution": self.resolution,
            "window_s": self.model.window,
            "error": own,
            "findings": self.model.findings,
        }


def identify_axis(recording: Recording) -> AxisFit:
    """Fit an axis to a recording of its position and of the torque of its drive.

    Args:
        recording: What :func:`furuta.read_axis` returned.

    Raises:
        ParameterError: The axis hardly moves, or the recording does not determine its inertia.
    """
    _refuse_rest(recording)
    units, start = _first_estimate(recording)
    excerpts = excerpts_of(_prepared(recording, *units), MOST_SAMPLES)
    scale = np.median([noise_of(excerpt) for excerpt in excerpts], axis=0)
    optimum = fit_growing_segments(excerpts, UNKNOWNS, start, SEGMENT, scale)
    # While the axis slides an asymmetry has the same effect as an offset.
    names = [*UNKNOWNS, *identifiable(optimum, ["asymmetry"])]
    if len(excerpts) == 1:
        optimum = _freely(optimum)
    optimum = optimum.refitted(names, optimum.values, FINE)
    certainty = covariance_and_information(optimum, {})
    window, scale = optimum.window, optimum.scale
    findings = findings_of(excerpts)
    model = Model(optimum.values, names, *certainty, window, scale, excerpts, findings)
    return _result(model, units, quantisation_step(recording.measured[:, PHI]))


def _freely(optimum: Optimum) -> Optimum:
    """The fit of a free run, or the given one of segments if no free run follows the recording."""
    (recording,) = optimum.recordings
    free = optimise([recording], OFFSET, optimum.values, np.inf, optimum.scale, robust=True)
    free = optimise([recording], UNKNOWNS, free.values, np.inf, residual_scale(free), robust=True)
    predicted = free.predictions[0][1]
    fit = fit_percent(recording.measured[:, PHI], predicted[:, PHI])
    return free if fit >= SMALLEST_FIT else optimum


def _prepared(recording: Recording, position: float, torque: float) -> Recording:
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
    moving = with_speeds(_prepared(recording, 1.0, size), 0.0)
    position = float(np.sqrt(np.mean(moving.measured[:, PHI_DOT] ** 2))) / SPEED
    moving = with_speeds(_prepared(recording, position, size), 0.0)
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
        alpha1=STICTION,
        offset=scale * 0.5 * (forward - backward),
        sigma0=stiffness,
        sigma1=2.0 * DAMPING * stiffness / STUCK,
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


def _errors(model: Model, recordings: list[Recording]) -> float:
    """Root mean square error of the position in the recordings, in the units of the model."""
    errors = [r.measured[:, PHI] - model.predict(r).predicted[:, PHI] for r in recordings]
    return float(np.sqrt(np.mean(np.concatenate(errors) ** 2)))


def _result(model: Model, units: tuple[float, float], resolution: float) -> AxisFit:
    """Values and standard errors in the units of the recording."""
    reasons = undetermined(model)
    if "arm_inertia" in reasons:
        raise ParameterError(
            f"{model.recordings[0].name}: the inertia is not determined: {reasons['arm_inertia']}; "
            "record a motion that accelerates"
        )
    for name, other in (("alpha1", "stribeck_velocity"), ("stribeck_velocity", "alpha1")):
        if other in reasons:
            reasons[name] = reasons[other]
    position, torque = units
    values, errors = {}, {}
    for name, (unknown, of_torque, of_position) in REPORTED.items():
        if unknown in reasons:
            continue
        index = model.names.index(unknown)
        value, error = model.values[unknown], np.sqrt(model.covariance[index, index])
        unit = torque**of_torque * position**of_position
        values[name] = float(unit * value)
        errors[name] = float(unit * error * (value if unknown in LOGARITHMIC else 1.0))
    missing = {name: reasons[of[0]] for name, of in REPORTED.items() if of[0] in reasons}
    return AxisFit(values, errors, missing, resolution, units, model)
