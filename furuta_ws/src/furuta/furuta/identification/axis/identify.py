"""Identifies a single axis from recordings of its position and of what drives it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from furuta.identification.axis.averaging import Averaged, described
from furuta.identification.axis.balance import Balance, balanced
from furuta.identification.axis.effects import (
    ALWAYS,
    FALL,
    GRAVITY,
    SURE,
    Group,
    Scales,
    averaged_errors,
    fitted,
    largest_hidden_fall,
    supported,
)
from furuta.identification.axis.segments import segmented, smoothed
from furuta.identification.axis.start import first_values
from furuta.identification.bodies.axis import wave
from furuta.identification.bodies.body import Segments
from furuta.identification.errors import quantisation_step
from furuta.identification.least_squares import COARSE, Fit
from furuta.identification.options import silent
from furuta.identification.selection import chance_of, significance
from furuta.identification.unknowns import Key, field_of, name_of
from furuta.identification.verdict import DOUBTFUL, NO, Verdict
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.cleaning import cleaned
from furuta_recordings.recording import Recording, findings_of
from furuta_recordings.splitting import split_into_runs

# Fewest counts of the sensor over which the axis must move; travel [rad] from which gravity differs
# from a spring.
COUNTS, GRAVITY_TRAVEL = 8.0, 0.7
# Shortest interval [s] between samples that is fitted.
THINNED = 1e-3
# Delay [s] that drives seldom have.
LONG_DELAY = 0.02
# Residuals in the noise of the position from which a fit is started from the torques as well.
POOR = 3.0
# Size of the residuals in the noise of the position that a fit has which explains the recording: an
# axis at rest keeps an error of up to half a count. How often the errors of the model take the
# place of that noise otherwise.
EXPLAINED, REWEIGHTED = 3.0**0.5, 4
# Residuals in the noise that was assumed from which that is assumed anew.
EXCESSIVE = 0.7
# Residuals as a part of the motion that forces cause within a segment, above which the values are
# doubtful, useless, or not worth a fit; where the residuals are noise, it does not matter.
DOUBTFUL_PART, USELESS_PART, UNEXPLAINED_PART = 0.005, 0.15, 0.6
# Friction under load that makes other values so much smaller that it is named.
SMALL_LOAD = 0.05
# Part of that motion which is noise where the noise is as large as the rest.
NOISY_PART = 0.5**0.5
# Part of a row within which it is not known when its torque began.
WITHIN_ROW = 0.1
# Fewest segments for each unknown, and largest standard error of a usable inertia.
FEWEST_SEGMENTS, LARGEST_ERROR = 2.0, 0.2
# Probability by chance up to which an effect is reported.
BY_CHANCE = 1e-3
# Correlation from which friction and offset are one, and part of the largest speed up to which an
# axis does not turn back: it slides in one direction only.
ONE_WAY, BACKWARD = 0.999, 0.01
# What is said of a value that may be 0, and of a fit of the torques.
NOT_DISTINGUISHABLE = "not distinguishable from 0"
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

    @property
    def verdict(self) -> Verdict:
        """Whether the values are usable, and why not."""
        return Verdict(self.usable, self.reasons)

    def error(self, recording: Recording, own_offset: bool = False) -> float:
        """Root mean square error of the free run over a recording, in the unit of position.

        The model gets the torque, but the position only at the start. The drift is left out; the
        offset is that of the fit, or the recording's ``own_offset``.
        """
        return _free_runs(self, recording, (("offset", 0),) if own_offset else ())

    @property
    def own_error(self) -> float:
        """That of the free run over the first recording, with its own offset and drift."""
        return _free_runs(self, self.recordings[0], (("offset", 0), "drift"))

    def unit(self, name: str) -> str:
        """The unit of a value; empty for a number."""
        return unit_of(name, self.recordings[0].units)


def identify_axis(
    recordings: Recording | Sequence[Recording], report: Callable[[str], None] = silent
) -> AxisFit:
    """Fit an axis to recordings, which have their own offsets; ``report`` gets each stage.

    Raises :class:`ParameterError` if the axis hardly moves or its inertia is not determined.
    """
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    ready = [_prepared(recording) for recording in given]
    cut = segmented(ready)
    report("fitting inertia and friction to the motion")
    starts = _first_fits(ready, cut)
    base, scales = next(starts)
    torques = balanced(ready, base, scales) if base.rms > POOR else None
    if torques is not None:
        base = _from_torques(cut, base, torques, scales)
    if base.rms > POOR:
        base = min([base, *(other for other, _ in starts)], key=lambda each: each.cost)
    sensor = _noise(cut)
    part = unexplained(base.rms, base.rms * sensor / _forced_motion(cut))
    for _ in range(REWEIGHTED):
        cut, base = _reweighted(cut, base, scales)
        if EXCESSIVE <= base.rms <= EXPLAINED:
            break
    best = base
    if part <= UNEXPLAINED_PART or torques is None or torques.part <= UNEXPLAINED_PART:
        report("looking for further effects")
        best = supported(cut, base, scales, drift=len(ready) == 1)
        if best.rms < EXCESSIVE:
            cut, best = _reweighted(cut, best, scales)
            best = supported(cut, best, scales, drift=len(ready) == 1)
        if best.values["delay"] > LONG_DELAY:
            prompt = _without_delay(cut, base, scales, drift=len(ready) == 1)
            best = min(best, prompt, key=lambda each: each.cost)
        cut, best = _reweighted(cut, best, scales)
    left = best.rms * _noise(cut)
    part = unexplained(left / sensor, left / _forced_motion(cut))
    report("computing standard errors")
    if part <= USELESS_PART:
        return _result(ready, cut, best, scales, sensor)
    if torques is not None and torques.part <= USELESS_PART and torques.fit.values["inertia"] > 0.0:
        return _result(ready, cut, base, scales, sensor, torques)
    if part > UNEXPLAINED_PART:
        raise ParameterError(
            f"{ready[0].name}: the torque does not explain how the axis moves; check sign, column "
            "and clock of the torque"
        )
    return _result(ready, cut, best, scales, sensor)


def unexplained(noises: float, part: float) -> float:
    """The part of the motion that is left over; 0 where that is no more than noise."""
    return part if noises > EXPLAINED else 0.0


def _reweighted(cut: Segments, best: Fit, scales: Scales) -> tuple[Segments, Fit]:
    """With the residuals of a fit as the noise, if they are no noise of the position; and the fit.

    They also make the first states uncertain. Priors count as much as independent residuals.
    """
    factor = 1.0 if EXCESSIVE <= best.rms <= EXPLAINED else best.rms
    cut = cut.with_noise(factor, best.inflation(SURE) / factor**2)
    return cut, fitted(cut, best.unknowns.keys, scales, best.values, best.state.first, COARSE)


def _without_delay(cut: Segments, base: Fit, scales: Scales, drift: bool) -> Fit:
    """The fit with all effects that are supported if the torque acts at once, then with a delay.

    Without a fall of friction a long delay may be the better fit, and hide the fall.
    """
    keys = [key for key in base.unknowns.keys if key != "delay"]
    start = fitted(cut, keys, scales, {**base.values, "delay": 0.0}, enough=COARSE)
    best = supported(cut, start, scales, drift)
    keys = ["inertia", "alpha0", "viscous", "delay", *best.unknowns.keys]
    return fitted(cut, dict.fromkeys(keys), scales, best.values, best.state.first)


def _from_torques(cut: Segments, base: Fit, torques: Balance, scales: Scales) -> Fit:
    """A fit from the values that balance the torques, if it explains the motion better.

    They are found without a start, and with the effects that the torques show.
    """
    falling = [torques.start] if torques.start["alpha1"] else []
    for start in (torques.fit.values, *falling):
        if start["inertia"] <= 0.0 or base.rms < POOR:
            continue
        keys = dict.fromkeys((*base.unknowns.keys, *torques.fit.unknowns.keys))
        keys |= dict.fromkeys(FALL if start["alpha1"] else ())
        values = {**start, "delay": base.values["delay"], "alpha0": max(start["alpha0"], 0.0)}
        other = fitted(cut, keys, scales, values, enough=COARSE)
        base = min(base, other, key=lambda each: each.cost)
    return base


def _prepared(recording: Recording) -> Recording:
    """The usable part, with time 0 in its middle; raises if the axis hardly moves."""
    ready = usable_part(recording)
    middle = 0.5 * (ready.time[0] + ready.time[-1])
    return ready._replace(time=ready.time - middle, command_time=ready.command_time - middle)


def usable_part(recording: Recording) -> Recording:
    """The usable part, at no more than 2 kHz.

    Raises:
        ParameterError: The axis hardly moves.
    """
    if len(recording.command) and np.ptp(recording.command) == 0.0:
        constant = recording.command[0] + 0.0  # no -0
        raise ParameterError(
            f"{recording.name}: the torque is {constant:g} throughout; name another column with "
            "--command"
        )
    travel, count = (f(recording.measured[:, PHI]) for f in (_travel, quantisation_step))
    if not travel >= COUNTS * count > 0.0:
        raise ParameterError(
            f"{recording.name}: the axis moves by {travel:g}, which is less than {COUNTS:g} counts "
            f"of {count:g} of its sensor; record a larger motion"
        )
    return _thinned(cleaned(recording, joints=(PHI,)))


def _thinned(recording: Recording) -> Recording:
    """A recording at 1 to 2 kHz of one that was faster, with the mean of its commands between."""
    every = int(THINNED / recording.interval) if recording.interval else 1
    together = np.array_equal(recording.time, recording.command_time)
    if every < 2 or not together:
        return recording
    starts = np.arange(0, len(recording.time), every)
    means = np.add.reduceat(recording.command, starts)
    thinned = recording._replace(
        time=recording.time[starts],
        measured=recording.measured[starts],
        command_time=recording.time[starts],
        command=means / np.diff(np.append(starts, len(recording.time))),
    )
    rate = 1e-3 / recording.interval
    return thinned.noting(f"{rate:.3g} kHz: every {every}th position, and the mean of its torques")


def unit_of(name: str, units: tuple[str, str]) -> str:
    """The unit of a value, from those of position and torque; empty for a number."""
    position, torque = units
    if units == ("rad", "N m"):
        inertia = "kg m²"
    elif units == ("m", "N"):
        inertia = "kg"
    else:
        inertia = f"{torque} s²/{position}"
    known = {
        "inertia": inertia,
        "viscous": f"{torque} s/{position}",
        "viscous_difference": f"{torque} s/{position}",
        "drag": f"{torque} s²/{position}²",
        "spring": f"{torque}/{position}",
        "drift": f"{torque}/s",
        "delay": "s",
        "stribeck_velocity": f"{position}/s",
        "asymmetry": "",
        "load_friction": "",
        "gravity_friction": "",
    }
    return known.get(name, torque)


def _travel(position: np.ndarray) -> float:
    known = position[np.isfinite(position)]
    return float(np.ptp(known)) if len(known) else 0.0


def _first_fits(recordings: Sequence[Recording], cut: Segments) -> Iterator[tuple[Fit, Scales]]:
    """Fits without further effects, and the usual sizes of everything."""
    even = [smoothed(recording) for recording in recordings]
    speed = float(np.sqrt(np.mean(np.concatenate([each.speed for each in even]) ** 2)))
    torque = float(np.sqrt(np.mean(np.concatenate([each.torque for each in even]) ** 2)))
    travel = max(float(np.ptp(each.position)) for each in even)
    length = max(recording.duration for recording in recordings)
    gravity = GRAVITY if travel > GRAVITY_TRAVEL else ()
    offsets = [("offset", number) for number in range(len(recordings))]
    for values in first_values(recordings, even, bool(gravity)):
        scales = Scales(torque, values["alpha0"], speed, travel, length)
        keys = (*ALWAYS, *offsets, *gravity)
        yield fitted(cut, keys, scales, values, enough=COARSE), scales


def _result(
    recordings: list[Recording],
    cut: Segments,
    best: Fit,
    scales: Scales,
    sensor: float,
    torques: Balance | None = None,
) -> AxisFit:
    """Values, errors and verdict, from the balance of torques if it is given."""
    left = best.rms * _noise(cut)
    part, covered = left / _forced_motion(cut), best.covariance
    hidden = largest_hidden_fall(cut, best, scales)
    about = Averaged(covered, [])
    if torques is not None:
        best, covered, part, _ = torques
    else:
        about = averaged_errors(cut, best, scales, drift=len(recordings) == 1)
        covered = about.covariance.copy()
        if "delay" in best.unknowns.keys:
            k = best.unknowns.keys.index("delay")
            instant = WITHIN_ROW * max(each.interval for each in recordings)
            covered[k, k] += (instant / best.unknowns[k].size) ** 2
    values, errors, undetermined = reported_values(best, covered)
    undetermined |= _explained_otherwise(best, about, undetermined)
    one_way = _one_way(recordings, best, covered)
    undetermined |= one_way
    values, errors = (
        {name: value for name, value in each.items() if name not in undetermined}
        for each in (values, errors)
    )
    if best.values["alpha1"] and "alpha1" not in best.unknowns.keys:
        value, error = float(best.values["alpha1"]), about.stiction
        if significance(np.array([value]), np.array([[error**2]]), best.segments) < BY_CHANCE:
            values["alpha1"], errors["alpha1"] = value, error
        else:
            undetermined["alpha1"] = f"{value:.3g} ± {error:.2g}: {NOT_DISTINGUISHABLE}"
        undetermined["stribeck_velocity"] = "friction falls at once after breakaway"
    for name in FALL:
        if name not in {*values, *undetermined}:
            undetermined[name] = (
                f"no fall of friction after breakaway seen; stiction of up to {hidden:.2g} above "
                "alpha0 would not show"
            )
    noises = left / sensor if torques is None else np.inf
    moved = f"motion, {noises:.1f} times the noise of the position"
    of = moved if torques is None else "torque"
    relative = errors["inertia"] / values["inertia"] if "inertia" in values else np.inf
    doubts = list(doubts_of(best, noises, part, relative, of))
    if noises <= EXPLAINED and part > NOISY_PART:
        why = "the noise of the position is larger than the motion that forces cause"
        doubts.append((DOUBTFUL, f"{why}: record larger accelerations"))
    if one_way:
        doubts.append((DOUBTFUL, "the axis slides in one direction only: record reversals"))
    verdict = Verdict.of(doubts)
    findings = findings_of(recordings)
    if values.get("delay", 0.0) < 0.0:
        late = -1e3 * values["delay"]
        findings.append(
            f"{recordings[0].name}: the torque is recorded {late:.2g} ms after it acted"
        )
    if torques is not None:
        findings.append(f"{recordings[0].name}: {BALANCED}")
        undetermined["delay"] = "taken as 0, and its possible effect is part of the errors"
        undetermined["asymmetry"] = "acts like an offset while the axis slides"
    return AxisFit(
        values,
        errors,
        undetermined,
        tuple(map(name_of, best.unknowns.keys)),
        covered * np.outer(best.unknowns.all("size"), best.unknowns.all("size")),
        *verdict,
        findings,
        quantisation_step(recordings[0].measured[:, PHI]),
        hidden,
        left / sensor,
        part,
        best,
        tuple(recordings),
    )


def _explained_otherwise(
    best: Fit, about: Averaged, undetermined: dict[str, str]
) -> dict[str, str]:
    """Why values are undetermined that would be determined if other effects were known."""
    found = {}
    for key, rival in zip(best.unknowns.keys, about.rivals, strict=bool(about.rivals)):
        alone = chance_of(best, _together(key, best)) < BY_CHANCE
        if rival is not None and alone and name_of(key) in undetermined:
            why = undetermined[name_of(key)].removesuffix(NOT_DISTINGUISHABLE)
            found[name_of(key)] = why + described(rival)
    if about.load > SMALL_LOAD and "load_friction" not in best.unknowns.keys:
        found["load_friction"] = (
            f"one of {about.load:.2g} would not show; all values would be as much smaller"
        )
    return found


def reported_values(
    best: Fit, covered: np.ndarray
) -> tuple[dict[str, float], dict[str, float], dict[str, str]]:
    """Values and standard errors of what is determined, and why the rest is not."""
    values: dict[str, float] = {}
    errors: dict[str, float] = {}
    undetermined: dict[str, str] = {}
    deviations = best.unknowns.all("size") * np.sqrt(np.diag(covered))
    for key, error in zip(best.unknowns.keys, map(float, deviations), strict=True):
        reported = "offset" if key == ("offset", 0) else name_of(key)
        groups = [_together(key, best)] + ([FALL[:1]] if key == FALL[1] else [])
        certain = all(chance_of(best, group, covered) < BY_CHANCE for group in groups)
        free = (
            field_of(key) == "offset" and error < best.unknowns[best.unknowns.keys.index(key)].size
        )
        if free or certain:
            values[reported], errors[reported] = best.values[key], error
        else:
            undetermined[reported] = f"{best.values[key]:.3g} ± {error:.2g}: {NOT_DISTINGUISHABLE}"
    return values, errors, undetermined


def _one_way(recordings: Sequence[Recording], best: Fit, covered: np.ndarray) -> dict[str, str]:
    """Why level, offset and asymmetry are not determined if the axis slides in one direction only.

    Either it never turns back, or their errors are one.
    """
    keys = best.unknowns.keys
    if not {"alpha0", ("offset", 0)} <= set(keys):
        return {}
    level, offset = keys.index("alpha0"), keys.index(("offset", 0))
    correlation = covered[level, offset] / np.sqrt(covered[level, level] * covered[offset, offset])
    speed = np.concatenate([smoothed(recording).speed for recording in recordings])
    side = np.sign(np.mean(speed))
    turns_back = np.min(side * speed) < -BACKWARD * np.max(np.abs(speed))
    if turns_back and not abs(correlation) > ONE_WAY:
        return {}
    total = best.values["offset", 0] + side * best.values["alpha0"]
    reason = f"only level and offset together are, {total:.3g}: the axis slides in one direction"
    return dict.fromkeys(("alpha0", "offset", "asymmetry"), reason)


def _together(key: Key, best: Fit) -> Group:
    """The unknowns that are one effect: those of gravity, or of a wave."""
    group = wave(int(key[1])) if field_of(key) in ("cos", "sin") else GRAVITY
    return group if key in group and set(group) <= set(best.unknowns.keys) else (key,)


def doubts_of(
    best: Fit, noises: float, part: float, inertia_error: float, of: str
) -> Iterator[tuple[str, str]]:
    """What makes the values less usable; what is left over is a ``part`` ``of`` that."""
    if noises > EXPLAINED and part > DOUBTFUL_PART:
        yield (
            NO if part > USELESS_PART else DOUBTFUL,
            f"the model leaves {100.0 * part:.1f} % of the {of}: something acts that it does not "
            "have",
        )
    segments, unknown = best.segments, len(best.unknowns)
    if segments < FEWEST_SEGMENTS * unknown:
        yield DOUBTFUL, f"{segments} segments for {unknown} unknowns: record for longer"
    if not np.isfinite(inertia_error):
        yield DOUBTFUL, "the inertia is not determined: record a motion that accelerates"
    elif inertia_error > LARGEST_ERROR:
        yield DOUBTFUL, f"the inertia is known to {100.0 * inertia_error:.0f} % only"


def _noise(cut: Segments) -> float:
    """Standard deviation of a position."""
    return float(1.0 / cut.weight[0, 0])


def _forced_motion(cut: Segments) -> float:
    """Root mean square [rad] of the motion within segments beyond one at constant speed."""
    left = []
    for start, end in itertools.pairwise(cut.bounds):
        t, q = cut.time[start:end], cut.measured[start:end, 0]
        basis, _ = np.linalg.qr(np.column_stack((np.ones(len(t)), t - t[0])))
        left.append(q - basis @ (basis.T @ q))
    return float(np.sqrt(np.mean(np.concatenate(left) ** 2))) or 1e-300


def _free_runs(result: AxisFit, recording: Recording, free: Sequence[Key]) -> float:
    """Root mean square error over the runs between the pauses of a recording."""
    try:
        runs = split_into_runs(recording)
    except ParameterError:  # all are short
        runs = [recording]
    squares = [len(run.time) * _free_run(result, run, free) ** 2 for run in runs]
    return float(np.sqrt(np.sum(squares) / sum(len(run.time) for run in runs)))


def _free_run(result: AxisFit, recording: Recording, free: Sequence[Key]) -> float:
    """Root mean square error of a free run, with what is fitted to the recording."""
    whole = segmented([_prepared(recording)], np.inf)
    others = {("offset", number) for number in range(1, len(result.recordings))}
    values = {key: value for key, value in result.fit.values.items() if key not in others}
    run = fitted(whole, free, Scales(1.0, 1.0, 1.0, 1.0, 1.0), {**values, "drift": 0.0})
    return _noise(whole) * run.rms
