"""Identifies a single axis from recordings of its position and of what drives it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from furuta.identification.averaging import Averaged, described
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
from furuta.identification.axis.fit import AxisFit
from furuta.identification.axis.preparation import prepared, unit_of
from furuta.identification.axis.segments import segmented, smoothed
from furuta.identification.axis.start import first_values
from furuta.identification.bodies.axis import Axis, wave
from furuta.identification.bodies.body import Segments
from furuta.identification.errors import quantisation_step
from furuta.identification.fitted import (
    BY_CHANCE,
    NOT_DISTINGUISHABLE,
    doubts_of,
    is_certain,
    natural,
    reported,
    residual_of,
)
from furuta.identification.least_squares import COARSE, Fit
from furuta.identification.options import silent
from furuta.identification.selection import chance_of
from furuta.identification.unknowns import Key, field_of, name_of
from furuta.identification.verdict import DOUBTFUL, EXPLAINED, NO, Residual, Verdict
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.recording import Recording, findings_of

# Travel [rad] from which gravity differs from a spring.
GRAVITY_TRAVEL = 0.7
# Delay [s] that drives seldom have.
LONG_DELAY = 0.02
# Residuals in the noise of the position from which a fit is started from the torques as well.
POOR = 3.0
# How often the errors of the model take the place of the noise of the position.
REWEIGHTED = 4
# Residuals in the noise that was assumed from which that is assumed anew.
EXCESSIVE = 0.7
# Residuals as a part of the motion that forces cause within a segment, from which a fit is not
# worth its search.
UNEXPLAINED_PART = 0.6
# Friction under load that makes other values so much smaller that it is named.
SMALL_LOAD = 0.05
# Part of that motion which is noise where the noise is as large as the rest.
NOISY_PART = 0.5**0.5
# Part of a row within which it is not known when its torque began.
WITHIN_ROW = 0.1
# Correlation from which friction and offset are one, and part of the largest speed up to which an
# axis does not turn back: it slides in one direction only.
ONE_WAY, BACKWARD = 0.999, 0.01
# What is said where no fall of friction or no delay is found, and of a fit of the torques.
NO_FALL = (
    "no fall of friction after breakaway seen; stiction of up to {:.2g} above alpha0 would not show"
)
NO_DELAY = "taken as 0, and its possible effect is part of the errors"
BALANCED = "fitted to the torque while the axis slides, because it does not predict the motion"


def identify_axis(
    recordings: Recording | Sequence[Recording], report: Callable[[str], None] = silent
) -> AxisFit:
    """Fit an axis to recordings, which have their own offsets; ``report`` gets each stage.

    Raises :class:`ParameterError` if the axis hardly moves or its inertia is not determined.
    """
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    ready = [prepared(recording)[0] for recording in given]
    cut = segmented(ready)
    report("fitting inertia and friction to the motion")
    starts = _first_fits(ready, cut)
    base, scales = next(starts)
    torques = balanced(ready, base, scales) if base.rms > POOR else None
    if torques is not None:
        base = _from_torques(cut, base, torques, scales)
    if base.rms > POOR:
        base = min([base, *(other for other, _ in starts)], key=lambda each: each.cost)
    sensor = cut.noise
    left = residual_of(base, cut, sensor)
    for _ in range(REWEIGHTED):
        cut, base = _reweighted(cut, base, scales)
        if EXCESSIVE <= base.rms <= EXPLAINED:
            break
    best = base
    if min(left.unexplained, torques.part if torques else 0.0) <= UNEXPLAINED_PART:
        report("looking for further effects")
        best = supported(cut, base, scales, drift=len(ready) == 1)
        if best.rms < EXCESSIVE:
            cut, best = _reweighted(cut, best, scales)
            best = supported(cut, best, scales, drift=len(ready) == 1)
        if best.values["delay"] > LONG_DELAY:
            prompt = _without_delay(cut, base, scales, drift=len(ready) == 1)
            best = min(best, prompt, key=lambda each: each.cost)
        cut, best = _reweighted(cut, best, scales)
    left = residual_of(best, cut, sensor)
    report("computing standard errors")
    balances = torques is not None and torques.residual.grade != NO
    if left.grade == NO and torques and balances and torques.fit.values["inertia"] > 0.0:
        return _result(ready, cut, base, scales, torques.residual, torques)
    if left.unexplained > UNEXPLAINED_PART:
        raise ParameterError(
            f"{ready[0].name}: the torque does not explain how the axis moves; check sign, column "
            "and clock of the torque"
        )
    return _result(ready, cut, best, scales, left)


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
        scales = Scales(torque, values["alpha0"], values["viscous"], speed, travel, length)
        keys = (*ALWAYS, *offsets, *gravity)
        yield fitted(cut, keys, scales, values, enough=COARSE), scales


def _result(
    recordings: list[Recording],
    cut: Segments,
    best: Fit,
    scales: Scales,
    residual: Residual,
    torques: Balance | None = None,
) -> AxisFit:
    """Values, errors and verdict, from the balance of torques if it is given."""
    hidden = largest_hidden_fall(cut, best, scales)
    if torques is not None:
        best, about = torques.fit, torques.averaged
    else:
        about = averaged_errors(cut, best, scales, drift=len(recordings) == 1)
    covered = about.covariance.copy()
    if "delay" in best.keys:
        k = best.keys.index("delay")
        instant = WITHIN_ROW * max(each.interval for each in recordings)
        covered[k, k] += (instant / best.unknowns[k].size) ** 2
    groups = {key: [_together(key, best)] for key in best.unknowns.keys}
    groups |= {FALL[1]: [FALL[1:], FALL[:1]]}
    report = reported(best, covered, groups, {("offset", 0): "offset"})
    report.withhold(_explained_otherwise(best, about, report.undetermined))
    one_way = _one_way(recordings, best, covered)
    report.withhold(one_way)
    if best.values["alpha1"] and "alpha1" not in best.keys:
        excess, error = float(best.values["alpha1"]), about.stiction
        report.add("alpha1", excess, error, is_certain(excess, error, best.segments))
        report.withhold({"stribeck_velocity": "friction falls at once after breakaway"})
    seen = {*report.values, *report.undetermined}
    report.withhold(
        dict.fromkeys([name for name in FALL if name not in seen], NO_FALL.format(hidden))
    )
    doubts = list(doubts_of(best, residual, report))
    if not residual.unexplained and residual.part > NOISY_PART:
        why = "the noise of the position is larger than the motion that forces cause"
        doubts.append((DOUBTFUL, f"{why}: record larger accelerations"))
    if one_way:
        doubts.append((DOUBTFUL, "the axis slides in one direction only: record reversals"))
    findings = findings_of(recordings)
    first, late = recordings[0], -1e3 * report.values.get("delay", 0.0)
    if late > 0.0:
        findings.append(f"{first.name}: the torque is recorded {late:.2g} ms after it acted")
    if torques is not None:
        findings.append(f"{first.name}: {BALANCED}")
        report.withhold({} if "delay" in best.keys else {"delay": NO_DELAY})
        report.withhold({"asymmetry": "acts like an offset while the axis slides"})
    return AxisFit(
        values=report.values,
        standard_errors=report.errors,
        undetermined=report.undetermined,
        units={name: unit_of(name, first.units) for name in report.values},
        verdict=Verdict.of(doubts),
        findings=findings,
        names=tuple(map(name_of, best.unknowns.keys)),
        covariance=natural(best, covered),
        means=best.unknowns.vector(best.values),
        joint=first.joint,
        interval=first.interval,
        position_unit=first.units[0],
        torque_unit=first.units[1],
        recorded_unit=first.position_unit,
        resolution=quantisation_step(first.measured[:, PHI]),
        hidden=hidden,
        residual=residual,
        recordings=tuple(recordings),
        fit=best,
        body=Axis(),
    )


def _explained_otherwise(
    best: Fit, about: Averaged, undetermined: dict[str, str]
) -> dict[str, str]:
    """Why values are undetermined that would be determined if other effects were known."""
    found = {}
    for key, rival in zip(best.unknowns.keys, about.rivals, strict=True):
        alone = chance_of(best, _together(key, best)) < BY_CHANCE
        if rival is not None and alone and name_of(key) in undetermined:
            why = undetermined[name_of(key)].removesuffix(NOT_DISTINGUISHABLE)
            found[name_of(key)] = why + described(rival)
    if about.load > SMALL_LOAD and "load_friction" not in best.unknowns.keys:
        found["load_friction"] = (
            f"one of {about.load:.2g} would not show; all values would be as much smaller"
        )
    return found


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
