"""Which effects a recording supports: each is tested by what the segments say of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from furuta.identification.bodies.axis import Axis, wave
from furuta.identification.bodies.body import Segments
from furuta.identification.errors import inverse
from furuta.identification.least_squares import (
    COARSE,
    FINE,
    Fit,
    Linearised,
    Problem,
    evaluated,
    fit,
    linearised,
    projection,
)
from furuta.identification.selection import chance_of, tested
from furuta.identification.unknowns import Key, Unknown, Unknowns, Values, field_of

# Unknowns that are one effect.
Group = tuple[Key, ...]
# Waves of the torque over the turn that an axis may have.
MOST_WAVES = 3
# Largest probability of an effect by chance at which it is fitted; a wave is the best of many.
BY_CHANCE, WAVE_BY_CHANCE = 0.01, 1e-5
# Orders of waves that are tried, and turns of a wave that the axis must travel.
ORDERS, TURNS = range(2, 49), 1.0
# Levels of what stiction adds, relative to the Coulomb level, and Stribeck velocities relative to
# the usual speed, that are tried.
EXCESSES, FINELY = np.geomspace(0.05, 1.5, 9), np.geomspace(0.03, 1.6, 40)
STRIBECK = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
# Standard deviation, before anything is known of it, of an asymmetry, of the drag at the usual
# speed in the Coulomb level, of friction per torque, and of any other effect in the usual torque.
ASYMMETRY, DRAG, LOAD, EFFECT = 0.2, 1.0, 0.3, 30.0
FALL = ("alpha1", "stribeck_velocity")
# Factors about a fall that is known; searches for a fall, and the probability by chance above which
# a wave is not tried again.
NEAR = np.append(1.0, 1.0 + np.outer((-1.0, 1.0), (0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.35)))
FALLS, MOST_FALLS, HOPELESS = 3, 2, 0.05
# Stribeck velocity, relative to the usual speed, of a fall that is over at once, which is stiction,
# and one that no recording tells from it.
AT_ONCE, SHORT = 1e-6, 1e-3
# Largest of some dozen values of noise, in its standard deviation.
LARGEST_NOISE = 2.0
# Smallest fall and smallest wave, in the Coulomb level: the steps of the integration err by as much
# as smaller ones.
SMALLEST = 0.01
# Increase of the squares, in those that count, that contradicts stiction: two standard errors.
HIDDEN = 4.0
# Unknowns of which every segment with motion informs.
SURE = ("inertia", "alpha0", "viscous")
# Values that are never negative, and largest factor of a positive one in an iteration.
LOWEST = {"delay": 0.0, "alpha0": 0.0, "alpha1": 0.0, "load_friction": 0.0}
POSITIVE, FACTOR = ("inertia", "stribeck_velocity"), 2.5
# Friction in proportion to the torque of the drive. Where it is not found, it is taken to be
# absent: moves at one torque do not tell it from the Coulomb level.
LOADED = "load_friction"
# Effects over the speed that may stand for a fall that has not been looked for yet.
LIKE_A_FALL = ("drag", "viscous_difference")
ALWAYS = ("inertia", "alpha0", "viscous", "delay", "spring", "asymmetry")
GRAVITY = ("gravity_sin", "gravity_cos")


class Scales:
    """Usual torque, level, speed and travel of the recordings, from which sizes follow."""

    def __init__(self, torque: float, level: float, speed: float, travel: float, length: float):
        self.torque, self.level, self.speed = torque, max(level, 0.02 * torque), speed
        self.travel, self.length = travel, length

    def unknown(self, key: Key, values: Values) -> Unknown:
        """An unknown, with the size of a usual change and the standard deviation of its prior."""
        effect = EFFECT * self.torque
        field = field_of(key)
        size, spread = {
            "inertia": (abs(values["inertia"]), np.inf),
            "alpha0": (self.level, np.inf),
            "viscous": (self.level / self.speed, np.inf),
            "delay": (0.002, np.inf),
            "spring": (self.level / self.travel, effect / self.travel),
            "asymmetry": (0.1, ASYMMETRY),
            "alpha1": (self.level, effect),
            "stribeck_velocity": (max(values["stribeck_velocity"], 1e-9), 10.0 * self.speed),
            "viscous_difference": (self.level / self.speed, effect / self.speed),
            "drag": (self.level / self.speed**2, DRAG * self.level / self.speed**2),
            "drift": (self.level / self.length, effect / self.length),
            "load_friction": (0.05, LOAD),
        }.get(field, (self.level, effect))
        factor = FACTOR if field in POSITIVE else np.inf
        return Unknown(key, LOWEST.get(field, -np.inf), spread=spread, size=size, factor=factor)


def problem_of(cut: Segments, keys: Iterable[Key], scales: Scales, values: Values) -> Problem:
    """The problem with some unknowns of an axis."""
    return Problem(Axis(), cut, Unknowns(scales.unknown(key, values) for key in keys))


def fitted(
    cut: Segments,
    keys: Iterable[Key],
    scales: Scales,
    values: Values,
    first: np.ndarray | None = None,
    enough: float = FINE,
) -> Fit:
    """The fit of some unknowns; those that the values do not have start from 0."""
    keys = tuple(keys)
    values = {**dict.fromkeys(keys, 0.0), **values}
    return fit(problem_of(cut, keys, scales, values), values, first, enough)


def supported(cut: Segments, base: Fit, scales: Scales, drift: bool) -> Fit:
    """The fit with all effects that the segments support."""
    best = _with_effects(cut, base, scales, drift)
    if fall := _falling(cut, best, scales):
        best = _with_effects(cut, fall, scales, drift)
    if best.values["alpha1"] and best.values["stribeck_velocity"] < SHORT * scales.speed:
        velocity = AT_ONCE * scales.speed
        best = fit_with_fall(cut, best, {**best.values, "stribeck_velocity": velocity}, scales)
    best = fitted(cut, best.unknowns.keys, scales, best.values, best.state.first)
    return _reduced(cut, best, scales)


def _with_effects(cut: Segments, best: Fit, scales: Scales, drift: bool) -> Fit:
    """The fit with all effects that act linearly and that the segments support."""
    groups: list[Group] = [(name,) for name in (*smooth_effects(drift), LOADED)]
    groups += wave_groups(scales)
    groups = [group for group in groups if group[0] not in best.unknowns.keys]
    hopeless: list[Group] = []
    while True:
        if len(waves_of(best)) >= MOST_WAVES:
            groups, hopeless = [group for group in groups if len(group) == 1], []
        chances, gains = _tested(cut, best, groups, scales)
        significant = chances < [_allowed(group) for group in groups]
        if not np.any(significant):
            if not hopeless:
                return best
            groups, hopeless = hopeless, []
            continue
        chosen = groups[int(np.argmax(np.where(significant, gains, -1.0)))]
        if chosen[0] in LIKE_A_FALL and not best.values["alpha1"]:
            fall, other = _falling(cut, best, scales), _extended(cut, best, chosen, scales)
            if fall and fall.cost < other.cost:
                best = fall
                continue
        # A wave that is far from significant now is tried again only when nothing else is left.
        kept = (chances < HOPELESS) | [len(group) == 1 for group in groups]
        hopeless += [g for g, k in zip(groups, kept, strict=True) if g != chosen and not k]
        groups = [g for g, k in zip(groups, kept, strict=True) if g != chosen and k]
        wider = _extended(cut, best, chosen, scales)
        sizes = [abs(wider.values[key]) for key in chosen]
        if len(chosen) > 1 and max(sizes) < SMALLEST * scales.level:
            continue
        best = wider
        if len(chosen) > 1:
            other = _exchanged(cut, best, chosen, scales)
            best = min(best, other, key=lambda each: each.cost)
            best = _without_gravity(cut, best, best.unknowns.keys[-2:], scales)


def wave_groups(scales: Scales) -> list[Group]:
    """Cosine and sine of each wave of which the axis travels a whole turn."""
    return [wave(n) for n in ORDERS if n * scales.travel > 2.0 * np.pi * TURNS]


def waves_of(best: Fit) -> list[Group]:
    """Cosine and sine of each wave that is fitted."""
    return [wave(int(key[1])) for key in best.unknowns.keys if field_of(key) == "cos"]


def _without(best: Fit, dropped: Iterable[Key]) -> tuple[list[Key], Values]:
    """Keys and values of a fit without some of the unknowns, which become 0."""
    keys = [key for key in best.unknowns.keys if key not in set(dropped)]
    return keys, {**best.values, **dict.fromkeys(dropped, 0.0)}


def _exchanged(cut: Segments, best: Fit, dropped: Sequence[Key], scales: Scales) -> Fit:
    """The fit without some unknowns, but with the wave that then explains most."""
    keys, values = _without(best, dropped)
    problem = problem_of(cut, keys, scales, values)
    without = best._replace(
        unknowns=problem.unknowns, state=evaluated(problem, values, best.state.first)
    )
    others = [group for group in wave_groups(scales) if group[0] not in keys]
    _, gains = _tested(cut, without, others, scales)
    other = others[int(np.argmax(gains))]
    return best if other == tuple(dropped) else _extended(cut, without, other, scales)


def alike(cut: Segments, best: Fit, scales: Scales) -> dict[Key, str]:
    """Amplitudes of waves in whose place a wave of another order explains as much, with a reason.

    Over a short travel neighbouring orders look alike.
    """
    found: dict[Key, str] = {}
    for own in waves_of(best):
        keys, values = _without(best, own)
        problem = problem_of(cut, keys, scales, values)
        state = evaluated(problem, values, best.state.first)
        without = best._replace(unknowns=problem.unknowns, state=state)
        groups = [group for group in wave_groups(scales) if group == own or group[0] not in keys]
        _, gains = _tested(cut, without, groups, scales)
        least = gains[groups.index(own)] - HIDDEN * best.inflation(SURE)
        others = [
            g[0][1] for g, gain in zip(groups, gains, strict=True) if g != own and gain > least
        ]
        if others:
            reason = f"a wave of order {' or '.join(map(str, others))} would explain as much"
            found |= dict.fromkeys(own, reason)
    return found


def _without_gravity(cut: Segments, best: Fit, wave: Sequence[Key], scales: Scales) -> Fit:
    """The fit with another wave instead of this one and gravity, if it explains as much.

    Over a part of a turn they are alike.
    """
    if not set(GRAVITY) <= set(best.unknowns.keys) or scales.travel > 2.0 * np.pi:
        return best
    other = _exchanged(cut, best, (*wave, *GRAVITY), scales)
    return other if other.cost < best.cost + HIDDEN * best.inflation(SURE) else best


def _allowed(group: Sequence[Key]) -> float:
    return BY_CHANCE if len(group) == 1 else WAVE_BY_CHANCE


def _reduced(cut: Segments, best: Fit, scales: Scales) -> Fit:
    """The fit without the effects that are not significant after all.

    One without which the fit ends in a much worse optimum stays.
    """
    for group in (*((name,) for name in (*smooth_effects(True), LOADED)), *waves_of(best)):
        if group[0] in best.unknowns.keys and chance_of(best, group) > _allowed(group):
            keys, values = _without(best, group)
            without = fitted(cut, keys, scales, values, best.state.first)
            best = best if _gained(without, best) else without
    if best.values["alpha1"]:
        keys = [key for key in best.unknowns.keys if key not in FALL]
        values = {**best.values, "alpha1": 0.0}
        without = fitted(cut, keys, scales, values, best.state.first)
        best = best if _gained(without, best) else without
    return best


def _extended(cut: Segments, best: Fit, more: Sequence[Key], scales: Scales) -> Fit:
    keys = (*best.unknowns.keys, *more)
    return fitted(cut, keys, scales, best.values, best.state.first, COARSE)


def _tested(
    cut: Segments, best: Fit, groups: Sequence[Group], scales: Scales
) -> tuple[np.ndarray, np.ndarray]:
    """Probability by chance (g,) of further effects, and the decreases of the squares (g,)."""
    if not groups:
        return np.zeros(0), np.zeros(0)
    known, more = best.unknowns.keys, [key for group in groups for key in group]
    about = _about(cut, best, (*known, *more), scales)
    rows = [[len(known) + more.index(key) for key in group] for group in groups]
    return tested(about, range(len(known)), rows)


def _about(cut: Segments, best: Fit, keys: Sequence[Key], scales: Scales) -> Linearised:
    """The problem about a fit with other unknowns."""
    values = {**dict.fromkeys(keys, 0.0), **best.values}
    return linearised(problem_of(cut, keys, scales, values), best.state._replace(values=values))


def covariance_with_missed(cut: Segments, best: Fit, scales: Scales, drift: bool) -> np.ndarray:
    """Covariance (p, p) of the unknowns in their sizes, with what is not in the model.

    An effect that was not found may be there: how its best value would change the others is part of
    their error, and so is how uncertain that value is.
    """
    covered, known, inflation = best.covariance, best.unknowns.keys, best.inflation(SURE)
    for name in smooth_effects(drift):
        if name in known:
            continue
        about = _about(cut, best, (*known, name), scales)
        inverted = inverse(about.information)
        shift = (inverted @ about.gradient)[:-1]
        wider = inverted[:-1, :-1] - inverse(about.information[:-1, :-1])
        covered = covered + np.outer(shift, shift) + inflation * wider
    return covered


def smooth_effects(drift: bool) -> tuple[str, ...]:
    """Effects beside those that are always fitted and waves."""
    return ("viscous_difference", "drag", *(("drift",) if drift else ()))


def _falling(cut: Segments, best: Fit, scales: Scales) -> Fit | None:
    """The fit with friction that falls after breakaway, if the segments support that.

    It acts not linearly, and on few segments: several falls are tried, and compared by their
    squares, which count less by how far the residuals are from white noise.
    """
    result = best
    for _ in range(FALLS):
        tried: list[Fit] = [
            fit_with_fall(cut, result, values, scales)
            for values in _best_falls(cut, result, scales)
        ]
        better = min(tried, key=lambda each: each.cost)
        if better.cost > result.cost - COARSE * result.rms**2:
            break
        result = better
    falls = result.values["alpha1"] > SMALLEST * scales.level
    return result if falls and _gained(best, result) else None


def _gained(without: Fit, wider: Fit) -> bool:
    """Whether squares decrease by more than chance explains."""
    return bool(np.exp(0.5 * (wider.cost - without.cost) / wider.inflation(SURE)) < BY_CHANCE)


def _projection(cut: Segments, best: Fit) -> Callable[[Values], np.ndarray]:
    return projection(Problem(Axis(), cut, best.unknowns), best)


def _best_falls(cut: Segments, about: Fit, scales: Scales) -> list[Values]:
    """Values that explain most segments after a step of all other unknowns."""
    project = _projection(cut, about)
    samples = cut.lengths

    def unexplained(values: Values) -> float:
        return float(np.sum(samples * np.log1p(project(values) / samples)))

    best = []
    for tried in _falls(about.values, scales):
        costs = [unexplained(values) for values in tried]
        best.append((min(costs), tried[int(np.argmin(costs))]))
    best.sort(key=lambda each: each[0])
    return [values for _, values in best[:MOST_FALLS]]


def fit_with_fall(cut: Segments, about: Fit, values: Values, scales: Scales) -> Fit:
    """The fit from values; a fall that is over at once is held, because squares are its stairs."""
    keys = [key for key in about.unknowns.keys if key not in FALL]
    more = FALL if values["stribeck_velocity"] > 2.0 * AT_ONCE * scales.speed else ()
    return fitted(cut, (*keys, *more), scales, values, about.state.first, COARSE)


def _falls(values: Values, scales: Scales) -> Iterable[list[Values]]:
    """Groups of values with other falls: about the one that there is, or of each velocity."""

    def fallen(excess: float, velocity: float) -> Values:
        return {**values, "alpha1": excess, "stribeck_velocity": velocity}

    if values["alpha1"]:
        excess, velocity = values["alpha1"], values["stribeck_velocity"]
        at_once = velocity <= 2.0 * AT_ONCE * scales.speed
        yield [fallen(k * excess, velocity) for k in NEAR if k != 1.0]
        for factor in () if at_once else (0.5, 2.0):
            yield [fallen(k * excess, factor * velocity) for k in NEAR]
        return
    for relative in STRIBECK:
        excesses = FINELY if relative == 0.0 else EXCESSES
        velocity = max(relative, AT_ONCE) * scales.speed
        yield [fallen(excess * scales.level, velocity) for excess in excesses]


def stiction_error(cut: Segments, best: Fit) -> float:
    """Standard error of a fall that is over at once.

    It has three parts: how far the segments do not contradict it, how it changes without one of
    them, and the noise of the torque, whose largest values seem to break the axis away too early.
    """
    project, fall, factors = _projection(cut, best), best.values["alpha1"], np.sort(NEAR)
    squares = np.array([project({**best.values, "alpha1": k * fall}) for k in factors])
    whole, count = squares.sum(axis=1), squares.shape[1]
    inside = np.flatnonzero(whole <= whole.min() + HIDDEN * best.inflation(SURE))
    low, high = factors[max(inside[0] - 1, 0)], factors[min(inside[-1] + 1, len(factors) - 1)]
    without = factors[np.argmin(whole - squares.T, axis=1)]
    own = fall * np.hypot(0.25 * (high - low), np.sqrt(count - 1.0) * np.std(without))
    jumps = np.median(np.abs(np.diff(cut.data.torque, n=3)))
    return float(np.hypot(own, LARGEST_NOISE * jumps / (0.6745 * np.sqrt(20.0))))


def largest_hidden_fall(cut: Segments, best: Fit, scales: Scales) -> float:
    """The largest stiction above the Coulomb level that the segments do not contradict."""
    project = _projection(cut, best)
    allowed = project(best.values).sum() + HIDDEN * best.inflation(SURE)
    at_once = {**best.values, "stribeck_velocity": AT_ONCE * scales.speed}
    excesses = [excess * scales.level for excess in FINELY]
    hidden = [e for e in excesses if project({**at_once, "alpha1": e}).sum() <= allowed]
    return max(hidden, default=0.0)
