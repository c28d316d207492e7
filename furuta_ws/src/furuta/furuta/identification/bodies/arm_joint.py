"""A joint of a moving arm as a body: the friction that its torque shows while all joints move.

The torque of the joint is that of its friction and of its drive's inertia, and the load by the
links. With the arm's geometry the load is linear in unknown parameters of the links. Without it,
it is approximated by products of speeds with sines and cosines of the angles. Positions are not
predicted: the torque is fitted where the joint slides in one direction.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from furuta.identification.averaging import Catalogue
from furuta.identification.axis.balance import (
    APART,
    FEWEST_BLOCKS,
    GAP,
    Rows,
    averaged_balance,
    fitted_balance,
    left_over,
    sliding_rows,
    torque_columns,
    window_length,
    with_effects,
)
from furuta.identification.axis.effects import Scales, wave_groups, waves_of
from furuta.identification.axis.preparation import unit_of, usable_part
from furuta.identification.axis.segments import Smoothed, position_noise, smoothed
from furuta.identification.axis.start import SLIDES
from furuta.identification.bodies.linkage import Loads, link_loads, read_linkage
from furuta.identification.errors import series_noise
from furuta.identification.fitted import (
    Fitted,
    doubts_of,
    is_certain,
    natural,
    reported,
)
from furuta.identification.least_squares import Fit
from furuta.identification.regression.windows import Windows
from furuta.identification.unknowns import Key, Values, field_of, name_of
from furuta.identification.verdict import DOUBTFUL, LIMITS, Residual, Verdict
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.cleaning import FEWEST_SAMPLES, cleaned
from furuta_recordings.recording import Recording, findings_of

# Shortest window [s]: an arm reverses often. Noise of the acceleration relative to it that is
# small: inertias are made too small by the square of it, and are known to 1e-3.
SHORTEST, SMALL = 0.06, 0.01
# Part of the time in which the joint slides that windows must cover; shorter ones cover more.
COVERED = 0.5
# What every joint has.
ALWAYS: tuple[Key, ...] = ("inertia", "alpha0", "viscous", ("offset", 0))
# Effects that are looked for, beside waves.
EFFECTS: tuple[Key, ...] = ("delay", "viscous_difference", "drag", "gravity_friction")
# A parameter of the links, of which several make one load.
LINK = "link"
# Part of a load that is rounding.
ROUNDING = 1e-6
# Part of a column of the links that others do not explain, below which it is left out.
INDEPENDENT = 0.02
# Friction level that is expected before anything is known, in the torque.
LEVEL = 0.1
# Fewest rows for each unknown.
FEWEST_ROWS = 3.0
# Samples over which a load is searched for its largest value: every so many.
EVERY = 10
# Friction by gravity changes what gravity is found to be: fits until that has settled.
SETTLED = 4


class _Arm(NamedTuple):
    """The joint, smoothed; the loads by the links; and usual sizes."""

    own: Recording
    part: Smoothed
    loads: Loads
    scales: Scales


def identify_arm_joint(
    recording: Recording, others: Sequence[Recording] = (), urdf: str | Path | None = None
) -> Fitted:
    """Fit the friction of one joint of an arm of which ``others`` move too.

    ``inertia`` is that against the joint's own acceleration, the mean over the recorded poses, and
    ``gravity`` the largest load by gravity. Unknowns ``link n`` are in ``names`` alone.

    Raises :class:`ParameterError` if the joint hardly moves, too little is recorded, or a name is
    not in the URDF.
    """
    own, positions = _together(recording, others)
    arm, about = _arm(own, positions, urdf)
    length, none = window_length(own, SHORTEST, SMALL), np.zeros(len(arm.part.time))
    rows, size = _rows(arm, length, none)
    while length > SHORTEST and len(rows.torque) * APART * length < COVERED * _sliding(arm.part):
        length = max(length / 1.5, SHORTEST)
        rows, size = _rows(arm, length, none)
    if len(rows.torque) < FEWEST_ROWS * len(ALWAYS):
        raise ParameterError(
            f"{own.name}: the joint slides in one direction for {length:.2g} s in "
            f"{len(rows.torque)} places only; record longer or wider moves"
        )
    links = _independent(rows)
    always = links if urdf is not None else []
    first = _fitted(rows, always, arm)
    arm = arm._replace(
        scales=_scales(arm.part, max(first.values["alpha0"], 0.0), first.values["viscous"])
    )
    best, effects = first, [*((key,) for key in EFFECTS), *wave_groups()]
    few = best.segments < FEWEST_BLOCKS * best.determined
    if urdf is None:
        effects = [(key,) for key in links]
    elif few:
        effects = []
        about.append(f"{own.name}: too short to look for {', '.join(map(name_of, EFFECTS))}")
    catalogue = Catalogue(effects)
    for _ in range(SETTLED):
        weight = _functional(arm.loads.gravity, size, best) @ _vector(best)
        rows, size = _rows(arm, length, weight)
        rows, best = with_effects(rows, _fitted(rows, always, arm), arm.scales, catalogue)
        if "gravity_friction" not in best.keys:
            break
    covered = averaged_balance(rows, best, arm.scales, catalogue).covariance
    noises = rows.noise * best.rms / _noise(arm, best, length)
    left = Residual("torque", noises, left_over(rows, best))
    return _result(arm, best, covered, size, rows, left, about, urdf is not None)


def _together(
    recording: Recording, others: Sequence[Recording]
) -> tuple[Recording, dict[str, Recording]]:
    """The joint where the others have positions too, and those at its times, by joint."""
    names = [each.joint for each in (recording, *others)]
    if len(set(names)) < len(names):
        raise ParameterError(f"{recording.name}: a joint is named twice: {', '.join(names)}")
    own = usable_part(recording)
    found = []
    for other in others:
        ready = cleaned(other, driven=False, joints=(PHI,))
        time = ready.time + (ready.start - own.start)
        at = np.clip(np.searchsorted(time, own.time), 1, len(time) - 1)
        known = np.diff(time)[at - 1] < GAP * ready.interval
        known &= (own.time >= time[0]) & (own.time <= time[-1])
        own = own._replace(time=own.time[known], measured=own.measured[known])
        found.append((ready, time))
    if len(own.time) < FEWEST_SAMPLES:
        raise ParameterError(
            f"{recording.name}: {len(own.time)} samples have positions of all joints, at least "
            f"{FEWEST_SAMPLES} needed"
        )
    positions = {}
    for ready, time in found:
        measured = np.full_like(own.measured, np.nan)
        measured[:, PHI] = np.interp(own.time, time, ready.measured[:, PHI])
        positions[ready.joint] = ready._replace(time=own.time, measured=measured)
    return own, positions


def _arm(
    own: Recording, positions: Mapping[str, Recording], urdf: str | Path | None
) -> tuple[_Arm, list[str]]:
    """The joint among the others, and what is to be said of that."""
    part = smoothed(own)
    parts = {own.joint: part, **{name: smoothed(each) for name, each in positions.items()}}
    q = {name: each.position for name, each in parts.items()}
    v = {name: each.speed for name, each in parts.items()}
    scales = _scales(part, LEVEL * float(np.sqrt(np.mean(part.torque**2))), 0.0)
    if urdf is None:
        return _Arm(own, part, _dictionary(own.joint, q, v), scales), []
    joints = read_linkage(urdf)
    names = [joint.name for joint in joints if joint.kind != "fixed"]
    unknown = [name for name in parts if name not in names]
    if unknown:
        raise ParameterError(
            f"{urdf}: no moving joint {', '.join(unknown)}; it has {', '.join(names) or 'none'}"
        )
    still = [name for name in names if name not in parts]
    about = [f"{own.name}: taken to be fixed at 0: {', '.join(still)}"] if still else []
    return _Arm(own, part, link_loads(joints, own.joint, q, v), scales), about


def _sliding(part: Smoothed) -> float:
    """Time [s] in which the joint surely slides."""
    speed = np.abs(part.speed)
    return float(np.mean(speed > SLIDES * np.max(speed)) * np.ptp(part.time))


def _scales(part: Smoothed, level: float, viscous: float) -> Scales:
    torque, speed = (float(np.sqrt(np.mean(each**2))) for each in (part.torque, part.speed))
    travel, length = float(np.ptp(part.position)), float(np.ptp(part.time))
    return Scales(torque, level, viscous, speed, travel, length)


def _dictionary(own: str, q: Mapping[str, np.ndarray], v: Mapping[str, np.ndarray]) -> Loads:
    """Loads that arms of turning joints may have: sums of angles, and products of speeds."""
    none = np.zeros_like(q[own])
    waves = [wave(angle) for angle in q.values() for wave in (np.sin, np.cos)]
    sums = [q[a] + sign * q[b] for a, b in itertools.combinations(q, 2) for sign in (1.0, -1.0)]
    waves += [wave(angle) for angle in sums for wave in (np.sin, np.cos)]
    columns = [(none, wave, wave, none) for wave in waves]
    for name, speed in v.items():
        factors = waves if name == own else [np.ones_like(none), *waves]
        columns += [
            (factor * speed, none, none, factor if name == own else none) for factor in factors
        ]
    for a, b in itertools.combinations_with_replacement(v, 2):
        factors = [np.ones_like(none), *waves[: 2 * len(q)]]
        columns += [(none, factor * v[a] * v[b], none, none) for factor in factors]
    return Loads(*(np.column_stack(each) for each in zip(*columns, strict=True)))


def _rows(arm: _Arm, length: float, weight: np.ndarray) -> tuple[Rows, np.ndarray]:
    """The balance, with a known load by gravity (n,), and the links' columns divided by a size."""

    def columns(windows: Windows, own: Recording, part: Smoothed) -> dict[Key, np.ndarray]:
        found = torque_columns(windows, own, part, wave_groups(), arm.scales.level)
        found["gravity_friction"] = found["alpha0"] * windows.mean(np.abs(weight))
        links = windows.slope(arm.loads.momentum) + windows.mean(arm.loads.rest)
        found |= {(LINK, n): column for n, column in enumerate(links.T)}
        return found

    rows = sliding_rows([arm.own], length, columns)
    size = np.ones(arm.loads.rest.shape[1])
    if len(rows.torque):
        links = np.column_stack([rows.columns[LINK, n] for n in range(len(size))])
        size = np.sqrt(np.mean(links**2, axis=0))
        size[size < 1e-9 * np.max(size, initial=1e-300)] = np.inf
    for n, each in enumerate(size):
        rows.columns[LINK, n] = rows.columns[LINK, n] / each
    return rows, size


def _independent(rows: Rows) -> list[Key]:
    """Parameters of the links that act differently from each other and from the joint's own."""
    own = np.column_stack([rows.columns[key] for key in ALWAYS])
    basis = np.linalg.qr(own / np.linalg.norm(own, axis=0))[0]
    keys = [key for key in rows.columns if field_of(key) == LINK]
    left = np.column_stack([rows.columns[key] for key in keys])
    left = left - basis @ (basis.T @ left)
    size, chosen = np.sqrt(len(left)), list[Key]()
    while len(chosen) < len(keys):
        sizes = np.linalg.norm(left, axis=0)
        k = int(np.argmax(sizes))
        if sizes[k] < INDEPENDENT * size:
            break
        column = left[:, k] / sizes[k]
        left = left - np.outer(column, column @ left)
        chosen.append(keys[k])
    return chosen


def _fitted(rows: Rows, links: Sequence[Key], arm: _Arm) -> Fit:
    inertia = arm.scales.torque / float(np.sqrt(np.mean(arm.part.acceleration**2)))
    values: Values = {"inertia": inertia, "stribeck_velocity": arm.scales.speed}
    return fitted_balance(rows, (*ALWAYS, *links), arm.scales, values)


def _vector(best: Fit) -> np.ndarray:
    return best.unknowns.vector(best.values)


def _functional(columns: np.ndarray, size: np.ndarray, best: Fit) -> np.ndarray:
    """What the fitted unknowns contribute (n, p), of that of all parameters of the links."""
    none = np.zeros(len(columns))
    return np.column_stack(
        [
            columns[:, int(key[1])] / size[int(key[1])] if field_of(key) == LINK else none
            for key in best.unknowns.keys
        ]
    )


def _result(
    arm: _Arm,
    best: Fit,
    covered: np.ndarray,
    size: np.ndarray,
    rows: Rows,
    left: Residual,
    about: list[str],
    has_geometry: bool,
) -> Fitted:
    """Values, errors and verdict."""
    waves = {key: [wave] for wave in waves_of(best) for key in wave}
    # Each of what was left out may be as large as the usual torque.
    left_out, like = _left_out(rows, best) if has_geometry else ([], np.zeros((len(best.keys), 0)))
    like = like * arm.scales.torque
    sizes = best.unknowns.all("size")[:, None]
    report = reported(
        best, covered + (like / sizes) @ (like / sizes).T, waves, {("offset", 0): "offset"}
    )
    for key in best.keys:
        if field_of(key) == LINK:
            report.remove(name_of(key))
    covariance = natural(best, covered)
    rounding = ROUNDING * arm.scales.torque
    for name, row, others in _loads_of(arm, best, size, left_out):
        hidden = others * arm.scales.torque - row @ like
        value = abs(float(row @ _vector(best)))
        error = float(np.sqrt(row @ covariance @ row + hidden @ hidden))
        certain = is_certain(value, error, best.segments)
        report.add(name, value, error, certain and (name != "gravity" or value > rounding))
    reasons = {"asymmetry": "acts like an offset while the joint slides, and is a part of it"}
    if not has_geometry:
        reasons |= dict.fromkeys(("gravity", "offset"), "needs the arm's geometry")
        reasons |= {"gravity_friction": "is a part of alpha0; needs the arm's geometry"}
    report.withhold(reasons)
    doubts = list(doubts_of(best, left, report))
    if not left.unexplained and left.part > LIMITS[left.of].useless:
        doubts.append((DOUBTFUL, f"{100.0 * left.part:.0f} % of the torque is noise"))
    if not has_geometry:
        doubts.append((DOUBTFUL, "the load by the links is approximated: give the arm's geometry"))
    return Fitted(
        *report,
        {name: unit_of(name, arm.own.units) for name in report.values},
        Verdict.of(doubts),
        [*findings_of([arm.own]), *about],
        tuple(map(name_of, best.unknowns.keys)),
        covariance,
        left,
        (arm.own,),
        best,
        None,
    )


def _noise(arm: _Arm, best: Fit, length: float) -> float:
    """Standard deviation of an averaged torque by noise of torque and position."""
    windows = Windows(arm.part.time, length, APART)
    torque = series_noise(arm.own.command_time, arm.own.command) * windows.noise(0)
    inertia = position_noise(arm.own) * windows.noise(2) * best.values["inertia"]
    return float(np.hypot(torque, inertia))


def _loads_of(
    arm: _Arm, best: Fit, size: np.ndarray, left_out: Sequence[Key]
) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """How fitted unknowns (p,), and what was left out, make inertia and largest load by gravity."""
    others = [int(key[1]) for key in left_out]
    per_speed, gravity = np.mean(arm.loads.per_speed, axis=0), arm.loads.gravity[::EVERY]
    own = np.array([float(key == "inertia") for key in best.keys])
    yield (
        "inertia",
        own + _functional(per_speed[None], size, best)[0],
        (per_speed / size)[others],
    )
    weights = _functional(gravity, size, best)
    pose = int(np.argmax(np.abs(weights @ _vector(best))))
    yield "gravity", weights[pose], (gravity[pose] / size)[others]


def _left_out(rows: Rows, best: Fit) -> tuple[list[Key], np.ndarray]:
    """Parameters of the links that the recorded moves do not tell from what is fitted.

    And how much of each unknown (p, k) acts like them.
    """
    keys = [key for key in rows.columns if field_of(key) == LINK and key not in best.keys]
    fitted = np.column_stack([rows.columns[key] for key in best.keys])
    length = np.linalg.norm(fitted, axis=0)
    columns = np.column_stack([rows.columns[key] for key in keys]) if keys else fitted[:, :0]
    like = np.linalg.lstsq(fitted / length, columns, rcond=1e-9)[0] / length[:, None]
    return keys, like
