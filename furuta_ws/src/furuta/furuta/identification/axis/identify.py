"""Identifies a single axis from recordings of its position and of what drives it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from furuta.identification.axis.balance import Balance, balanced
from furuta.identification.axis.effects import (
    ALWAYS,
    FALL,
    GRAVITY,
    Scales,
    chance_of,
    covariance_with_missed,
    largest_hidden_fall,
    significance,
    stiction_error,
    supported,
    unknowns,
)
from furuta.identification.axis.fitting import COARSE, Fit, fit, value_of
from furuta.identification.axis.motion import AxisModel
from furuta.identification.axis.segments import Segmented, segmented, smoothed
from furuta.identification.axis.start import first_models
from furuta.identification.errors import quantisation_step
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording, findings_of

# Fewest counts of the sensor over which the axis must move; travel [rad] from which gravity differs
# from a spring.
COUNTS, GRAVITY_TRAVEL = 8.0, 0.7
# Size of the residuals in the noise of the position that a fit has which explains the recording;
# how often the errors of the model take the place of that noise otherwise.
EXPLAINED, REWEIGHTED = 1.3, 2
# Residuals as a part of the motion that forces cause within a segment, above which the values are
# doubtful, useless, or not worth a fit; where the residuals are noise, it does not matter.
DOUBTFUL, USELESS, UNEXPLAINED = 0.005, 0.15, 0.6
# Fewest segments for each unknown, and largest standard error of a usable inertia.
FEWEST_SEGMENTS, LARGEST_ERROR = 2.0, 0.2
# Probability by chance up to which an effect is reported.
BY_CHANCE = 1e-3
# What is said of a fit of the torques.
BALANCED = "fitted to the torque while the axis slides, because it does not predict the motion"


class AxisFit(NamedTuple):
    """Values and standard errors by name, in the units of position and torque.

    What the recording does not determine is only in ``undetermined``, with the reason. ``names``
    and ``covariance`` are those of all fitted unknowns. ``usable`` is yes, doubtful or no, with
    ``reasons``. ``resolution`` is the smallest change of the position. ``hidden`` is the largest
    stiction above the Coulomb level that the recording would not show. ``left`` are the residuals
    in the noise of the position, ``part`` relative to the motion that forces cause, or to the
    torque if that was fitted.
    """

    values: dict[str, float]
    standard_errors: dict[str, float]
    undetermined: dict[str, str]
    names: tuple[str, ...]
    covariance: np.ndarray
    usable: str
    reasons: list[str]
    findings: list[str]
    resolution: float
    hidden: float
    left: float
    part: float
    fit: Fit
    recordings: tuple[Recording, ...]

    def error(self, recording: Recording, own_offset: bool = False) -> float:
        """Root mean square error of the free run over a recording, in the unit of position.

        The model gets the torque, but the position only at the start. The drift is left out; the
        offset is that of the fit, or the recording's ``own_offset``.
        """
        return _free_run(self, recording, ("offset 0",) if own_offset else ())

    def report(self) -> dict[str, Any]:
        """Everything by name, as the command line prints it."""
        return {
            **self.values,
            "standard_errors": self.standard_errors,
            "undetermined": self.undetermined,
            "usable": self.usable,
            "reasons": self.reasons,
            "covariance": {"names": list(self.names), "values": self.covariance.tolist()},
            "resolution": self.resolution,
            "error": _free_run(self, self.recordings[0], ("offset 0", "drift")),
            "findings": self.findings,
        }


def identify_axis(recordings: Recording | Sequence[Recording]) -> AxisFit:
    """Fit an axis to recordings of its position and of the torque of its drive.

    Args:
        recordings: What :func:`furuta.read_axis` returned; several of the same axis have their own
            offsets.

    Raises:
        ParameterError: The axis hardly moves, or the recording does not determine its inertia.
    """
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    ready = [_prepared(recording) for recording in given]
    cut = segmented(ready)
    base, scales = _first_fit(ready, cut)
    sensor = cut.data.noise
    part = base.rms * sensor / _forced_motion(cut)
    for _ in range(REWEIGHTED if base.rms > EXPLAINED else 0):
        # Errors of the model are the noise then: they also make the first states uncertain.
        cut = cut.with_noise(base.rms * cut.data.noise)
        base = fit(cut, base.model, base.unknowns, base.state.first, COARSE)
    if part <= UNEXPLAINED:
        best = supported(cut, base, scales, drift=len(ready) == 1)
        if best.rms * cut.data.noise <= USELESS * _forced_motion(cut):
            return _result(ready, cut, best, scales, sensor)
    torques = balanced(ready, base, scales)
    if torques is not None and torques.part <= USELESS and torques.fit.model.inertia > 0.0:
        return _result(ready, cut, base, scales, sensor, torques)
    if part > UNEXPLAINED:
        raise ParameterError(
            f"{ready[0].name}: the torque does not explain how the axis moves; check sign, column "
            "and clock of the torque"
        )
    return _result(ready, cut, best, scales, sensor)


def _prepared(recording: Recording) -> Recording:
    """The usable part, with time 0 in its middle; raises if the axis hardly moves."""
    travel, count = (f(recording.measured[:, PHI]) for f in (_travel, quantisation_step))
    if not travel >= COUNTS * count > 0.0:
        raise ParameterError(
            f"{recording.name}: the axis moves by {travel:g}, which is less than {COUNTS:g} counts "
            f"of {count:g} of its sensor; record a larger motion"
        )
    ready = cleaned(recording, joints=(PHI,))
    middle = 0.5 * (ready.time[0] + ready.time[-1])
    return ready._replace(time=ready.time - middle, command_time=ready.command_time - middle)


def _travel(position: np.ndarray) -> float:
    known = position[np.isfinite(position)]
    return float(np.ptp(known)) if len(known) else 0.0


def _first_fit(recordings: Sequence[Recording], cut: Segmented) -> tuple[Fit, Scales]:
    """The fit without further effects, and the usual sizes of everything."""
    even = [smoothed(recording) for recording in recordings]
    speed = float(np.sqrt(np.mean(np.concatenate([each.speed for each in even]) ** 2)))
    torque = float(np.sqrt(np.mean(np.concatenate([each.torque for each in even]) ** 2)))
    travel = max(float(np.ptp(each.position)) for each in even)
    length = max(recording.duration for recording in recordings)
    gravity = GRAVITY if travel > GRAVITY_TRAVEL else ()
    offsets = [f"offset {number}" for number in range(len(recordings))]
    fits = []
    for model in first_models(recordings, even, bool(gravity)):
        scales = Scales(torque, model.alpha0, speed, travel, length)
        names = (*ALWAYS, *offsets, *gravity)
        fits.append((fit(cut, model, unknowns(names, scales, model), enough=COARSE), scales))
        if fits[-1][0].rms < EXPLAINED:
            break
    return min(fits, key=lambda each: each[0].cost)


def _result(
    recordings: list[Recording],
    cut: Segmented,
    best: Fit,
    scales: Scales,
    sensor: float,
    torques: Balance | None = None,
) -> AxisFit:
    """Values, errors and verdict, from the balance of torques if it is given."""
    left = best.rms * cut.data.noise
    part, covered = left / _forced_motion(cut), best.covariance
    hidden = largest_hidden_fall(cut, best, scales)
    if torques is not None:
        best, covered, part = torques
    elif left >= EXPLAINED * sensor:
        covered = covariance_with_missed(cut, best, scales, drift=len(recordings) == 1)
    values, errors, undetermined = _reported(best, covered)
    if best.model.alpha1 and "alpha1" not in best.unknowns.names:
        value, error = best.model.alpha1, stiction_error(cut, best)
        if significance(np.array([value]), np.array([[error**2]]), best.segments) < BY_CHANCE:
            values["alpha1"], errors["alpha1"] = value, error
        else:
            undetermined["alpha1"] = f"{value:.3g} ± {error:.2g}: not distinguishable from 0"
        undetermined["stribeck_velocity"] = "friction falls at once after breakaway"
    for name in FALL:
        if name not in {*values, *undetermined}:
            undetermined[name] = (
                f"no fall of friction after breakaway seen; stiction of up to {hidden:.2g} above "
                "alpha0 would not show"
            )
    if "inertia" in undetermined:
        raise ParameterError(
            f"{recordings[0].name}: the inertia is not determined: {undetermined['inertia']}; "
            "record a motion that accelerates"
        )
    noises = left / sensor if torques is None else np.inf
    usable, reasons = _verdict(best, noises, part, errors["inertia"] / values["inertia"])
    findings = findings_of(recordings)
    if torques is not None:
        findings.append(f"{recordings[0].name}: {BALANCED}")
        undetermined["delay"] = "taken as 0, and its possible effect is part of the errors"
        undetermined["asymmetry"] = "acts like an offset while the axis slides"
    return AxisFit(
        values,
        errors,
        undetermined,
        best.unknowns.names,
        covered * np.outer(best.unknowns.sizes, best.unknowns.sizes),
        usable,
        reasons,
        findings,
        quantisation_step(recordings[0].measured[:, PHI]),
        hidden,
        left / sensor,
        part,
        best,
        tuple(recordings),
    )


def _reported(
    best: Fit, covered: np.ndarray
) -> tuple[dict[str, float], dict[str, float], dict[str, str]]:
    """Values and standard errors of what is determined, and why the rest is not."""
    values: dict[str, float] = {}
    errors: dict[str, float] = {}
    undetermined: dict[str, str] = {}
    for name, size, variance in zip(
        best.unknowns.names, best.unknowns.sizes, np.diag(covered), strict=True
    ):
        reported = "offset" if name == "offset 0" else name
        value, error = value_of(best.model, name), float(size * np.sqrt(variance))
        needed = [_together(name, best)] + ([FALL[:1]] if name == FALL[1] else [])
        certain = all(chance_of(best, group, covered) < BY_CHANCE for group in needed)
        if name.startswith("offset") or certain:
            values[reported], errors[reported] = value, error
        else:
            undetermined[reported] = f"{value:.3g} ± {error:.2g}: not distinguishable from 0"
    return values, errors, undetermined


def _together(name: str, best: Fit) -> tuple[str, ...]:
    """The unknowns that are one effect: those of gravity, or of a wave."""
    kind, _, order = name.partition(" ")
    group = (f"cos {order}", f"sin {order}") if kind in ("cos", "sin") else GRAVITY
    return group if name in group and set(group) <= set(best.unknowns.names) else (name,)


def _verdict(best: Fit, noises: float, part: float, inertia_error: float) -> tuple[str, list[str]]:
    """Whether the values are usable, and why not."""
    reasons, usable = [], "yes"
    if noises > EXPLAINED and part > DOUBTFUL:
        usable = "no" if part > USELESS else "doubtful"
        of = "torque"
        if np.isfinite(noises):
            of = f"motion, {noises:.1f} times the noise of the position"
        reasons.append(
            f"the model leaves {100.0 * part:.1f} % of the {of}: something acts that it does not "
            "have"
        )
    segments, unknown = best.segments, len(best.unknowns.names)
    if segments < FEWEST_SEGMENTS * unknown:
        usable = "doubtful" if usable == "yes" else usable
        reasons.append(f"{segments} segments for {unknown} unknowns: record for longer")
    if inertia_error > LARGEST_ERROR:
        usable = "doubtful" if usable == "yes" else usable
        reasons.append(f"the inertia is known to {100.0 * inertia_error:.0f} % only")
    return usable, reasons


def _forced_motion(cut: Segmented) -> float:
    """Root mean square [rad] of the motion within segments beyond one at constant speed."""
    data, left = cut.data, []
    for start, end in itertools.pairwise(cut.bounds):
        t, q = data.time[start:end], data.position[start:end]
        basis, _ = np.linalg.qr(np.column_stack((np.ones(len(t)), t - t[0])))
        left.append(q - basis @ (basis.T @ q))
    return float(np.sqrt(np.mean(np.concatenate(left) ** 2))) or 1e-300


def _free_run(result: AxisFit, recording: Recording, fitted: tuple[str, ...]) -> float:
    """Root mean square error of a free run, with what is fitted to the recording."""
    whole = segmented([_prepared(recording)], np.inf)
    model: AxisModel = result.fit.model._replace(drift=0.0)
    model = model._replace(offsets=model.offsets[:1])
    scales = Scales(1.0, 1.0, 1.0, 1.0, 1.0)
    run = fit(whole, model, unknowns(fitted, scales, model))
    return float(whole.data.noise * run.rms)
