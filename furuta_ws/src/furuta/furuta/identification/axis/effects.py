"""Which effects a recording supports: each is tested by what the segments say of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.special import fdtrc

from furuta.identification.axis.fitting import (
    COARSE,
    Fit,
    Unknowns,
    changed,
    covariance,
    fit,
    linearised,
    projection,
    residuals,
    value_of,
)
from furuta.identification.axis.motion import MOST_WAVES, AxisModel
from furuta.identification.axis.segments import Segmented

# Largest probability of an effect by chance at which it is fitted; a wave is the best of many.
BY_CHANCE, WAVE_BY_CHANCE = 0.01, 1e-5
# Orders of waves that are tried, and turns of a wave that the axis must travel.
ORDERS, TURNS = range(2, 49), 1.0
# Levels of what stiction adds, relative to the Coulomb level, and Stribeck velocities relative to
# the usual speed, that are tried.
EXCESSES, FINELY = np.geomspace(0.05, 1.5, 9), np.geomspace(0.03, 1.6, 40)
STRIBECK = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
# Standard deviation, before anything is known of it, of an asymmetry, of the drag at the usual
# speed in the Coulomb level, and of any other effect in the usual torque.
ASYMMETRY, DRAG, EFFECT = 0.2, 0.1, 30.0
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
# Smallest fall, in the Coulomb level.
SMALLEST_FALL = 0.01
# Increase of the squares, in those that count, that contradicts stiction: two standard errors.
HIDDEN = 4.0
ALWAYS = ("inertia", "alpha0", "viscous", "delay", "spring", "asymmetry")
GRAVITY = ("gravity_sin", "gravity_cos")


class Scales:
    """Usual torque, level, speed and travel of the recordings, from which sizes follow."""

    def __init__(self, torque: float, level: float, speed: float, travel: float, length: float):
        self.torque, self.level, self.speed = torque, max(level, 0.02 * torque), speed
        self.travel, self.length = travel, length

    def of(self, name: str, model: AxisModel) -> tuple[float, float]:
        """Size of a usual change of an unknown, and standard deviation of its prior."""
        effect = EFFECT * self.torque
        return {
            "inertia": (model.inertia, np.inf),
            "alpha0": (self.level, np.inf),
            "viscous": (self.level / self.speed, np.inf),
            "delay": (0.002, np.inf),
            "spring": (self.level / self.travel, effect / self.travel),
            "asymmetry": (0.1, ASYMMETRY),
            "alpha1": (self.level, effect),
            "stribeck_velocity": (max(model.stribeck_velocity, 1e-9), 10.0 * self.speed),
            "viscous_difference": (self.level / self.speed, effect / self.speed),
            "drag": (self.level / self.speed**2, DRAG * self.level / self.speed**2),
            "drift": (self.level / self.length, effect / self.length),
        }.get(name, (self.level, effect))


def unknowns(names: Iterable[str], scales: Scales, model: AxisModel) -> Unknowns:
    """Unknowns of a model by name, with sizes and priors."""
    names = tuple(names)
    pairs = np.array([scales.of(name, model) for name in names]).reshape(-1, 2)
    return Unknowns(names, pairs[:, 0], pairs[:, 1])


def supported(cut: Segmented, base: Fit, scales: Scales, drift: bool) -> Fit:
    """The fit with all effects that the segments support."""
    best = base
    groups: list[tuple[str, ...]] = [(name,) for name in smooth_effects(drift)]
    groups += wave_groups(scales)
    for once in (True, False):
        while groups and len(best.model.waves) < MOST_WAVES:
            chances, gains = _chances(cut, best, groups, scales)
            significant = chances < [_allowed(group) for group in groups]
            if not np.any(significant):
                break
            chosen = groups[int(np.argmax(np.where(significant, gains, -1.0)))]
            # A wave that is far from significant now is not tried again.
            kept = (chances < HOPELESS) | [len(group) == 1 for group in groups]
            groups = [g for g, k in zip(groups, kept, strict=True) if g != chosen and k]
            best = _extended(cut, best, chosen, scales)
            if len(chosen) > 1:
                other = _exchanged(cut, best, chosen, scales)
                best = min(best, other, key=lambda each: each.cost)
                best = _without_gravity(cut, best, best.unknowns.names[-2:], scales)
        if once:
            best = _falling(cut, best, scales) or best
    if best.model.stribeck_velocity < SHORT * scales.speed:
        velocity = AT_ONCE * scales.speed
        model = best.model._replace(stribeck_velocity=velocity)
        best = fit_with_fall(cut, best, model, scales)
    return _reduced(cut, fit(cut, best.model, best.unknowns, best.state.first), scales)


def wave_groups(scales: Scales) -> list[tuple[str, ...]]:
    """Cosine and sine of each wave of which the axis travels a whole turn."""
    return [(f"cos {n}", f"sin {n}") for n in ORDERS if n * scales.travel > 2.0 * np.pi * TURNS]


def _without(best: Fit, dropped: Sequence[str], scales: Scales) -> tuple[AxisModel, Unknowns]:
    """Model and unknowns of a fit without some of the unknowns, which become 0."""
    model = changed(best.model, dropped, [0.0] * len(dropped))
    return model, unknowns((n for n in best.unknowns.names if n not in dropped), scales, model)


def _exchanged(cut: Segmented, best: Fit, dropped: Sequence[str], scales: Scales) -> Fit:
    """The fit without some unknowns, but with the wave that then explains most."""
    model, about = _without(best, dropped, scales)
    state = best.state._replace(model=model, residuals=residuals(model, best.state.first, cut.data))
    without = best._replace(state=state, unknowns=about)
    others = [group for group in wave_groups(scales) if group[0] not in about.names]
    _, gains = _chances(cut, without, others, scales)
    other = others[int(np.argmax(gains))]
    return best if other == tuple(dropped) else _extended(cut, without, other, scales)


def _without_gravity(cut: Segmented, best: Fit, wave: Sequence[str], scales: Scales) -> Fit:
    """The fit with another wave instead of this one and gravity, if it explains as much.

    Over a part of a turn they are alike.
    """
    if not set(GRAVITY) <= set(best.unknowns.names) or scales.travel > 2.0 * np.pi:
        return best
    other = _exchanged(cut, best, (*wave, *GRAVITY), scales)
    return other if other.cost < best.cost + HIDDEN * best.inflation else best


def _allowed(group: Sequence[str]) -> float:
    return BY_CHANCE if len(group) == 1 else WAVE_BY_CHANCE


def _reduced(cut: Segmented, best: Fit, scales: Scales) -> Fit:
    """The fit without the effects that are not significant after all."""
    waves = [(f"cos {int(n)}", f"sin {int(n)}") for n in best.model.waves[:, 0]]
    for group in (*((name,) for name in smooth_effects(True)), *waves):
        if group[0] in best.unknowns.names and chance_of(best, group) > _allowed(group):
            best = fit(cut, *_without(best, group, scales), best.state.first)
    if best.model.alpha1:
        names = [name for name in best.unknowns.names if name not in FALL]
        plain = best.model._replace(alpha1=0.0)
        without = fit(cut, plain, unknowns(names, scales, plain), best.state.first)
        best = best if _gained(without, best) else without
    return best


def chance_of(best: Fit, group: Sequence[str], covered: np.ndarray | None = None) -> float:
    """Probability by chance that unknowns of a fit are as far from 0 as they are."""
    rows = [best.unknowns.names.index(name) for name in group]
    values = np.array([value_of(best.model, name) for name in group]) / best.unknowns.sizes[rows]
    covered = best.covariance if covered is None else covered
    return significance(values, covered[np.ix_(rows, rows)], best.segments)


def _extended(cut: Segmented, best: Fit, more: Sequence[str], scales: Scales) -> Fit:
    model = best.model
    names = (*best.unknowns.names, *more)
    about = unknowns(names, scales, model)
    return fit(cut, model, about, best.state.first, COARSE)


def _chances(
    cut: Segmented, best: Fit, groups: Sequence[Sequence[str]], scales: Scales
) -> tuple[np.ndarray, np.ndarray]:
    """How much squares each group of further unknowns would explain, and whether by chance.

    Returns the probabilities by chance (g,), and the decreases of the squares (g,), by one
    Gauss-Newton step and its covariance by segments.
    """
    more = [name for group in groups for name in group]
    known = best.unknowns.names
    every = unknowns((*known, *more), scales, best.model)
    about = linearised(best.state, cut, every)
    chances, gains = [], []
    for group in groups:
        rows = [*range(len(known)), *(len(known) + more.index(name) for name in group)]
        information = about.information[np.ix_(rows, rows)]
        blocks = about.blocks[:, rows][:, :, rows]
        step, last = np.linalg.solve(information, about.gradient[rows]), len(group)
        scores = about.scores[:, rows] - blocks @ step
        chosen = Unknowns((), every.sizes[rows], every.priors[rows])
        part = about._replace(information=information, blocks=blocks, scores=scores)
        covered = covariance(part, chosen)[-last:, -last:]
        chances.append(significance(step[-last:], covered, len(scores)))
        inverse = np.linalg.pinv(information)[-last:, -last:]
        gains.append(step[-last:] @ np.linalg.pinv(inverse) @ step[-last:])
    return np.array(chances), np.array(gains)


def covariance_with_missed(cut: Segmented, best: Fit, scales: Scales, drift: bool) -> np.ndarray:
    """Covariance (p, p) of the unknowns in their sizes, with what is not in the model.

    Where the model does not explain the recording, an effect that was not found may be there: how
    its best value would change the others is part of their error.
    """
    covered, known, allowed = best.covariance, best.unknowns.names, best.inflation
    for name in smooth_effects(drift):
        if name in known:
            continue
        every = unknowns((*known, name), scales, best.model)
        about = linearised(best.state, cut, every)
        # A prior weighs as much against squares that are not those of white noise.
        prior = np.diag((allowed - 1.0) * (every.sizes / every.priors) ** 2)
        shift = np.linalg.solve(about.information + prior, about.gradient)[:-1]
        covered = covered + np.outer(shift, shift)
    return covered


def smooth_effects(drift: bool) -> tuple[str, ...]:
    """Effects beside those that are always fitted and waves."""
    return ("viscous_difference", "drag", *(("drift",) if drift else ()))


def significance(values: np.ndarray, covered: np.ndarray, segments: int) -> float:
    """Probability by chance that values (k,) of such a covariance are as far from 0 (Hotelling)."""
    distance = float(values @ np.linalg.pinv(covered) @ values)
    k = len(values)
    return float(fdtrc(k, segments - k, distance / k * (segments - k) / (segments - 1)))


def _falling(cut: Segmented, best: Fit, scales: Scales) -> Fit | None:
    """The fit with friction that falls after breakaway, if the segments support that.

    It acts not linearly, and on few segments: several falls are tried, and compared by their
    squares, which count less by how far the residuals are from white noise.
    """
    result = best
    for _ in range(FALLS):
        tried: list[Fit] = [
            fit_with_fall(cut, result, model, scales) for model in _best_falls(cut, result, scales)
        ]
        better = min(tried, key=lambda each: each.cost)
        if better.cost > result.cost - COARSE * result.rms**2:
            break
        result = better
    falls = result.model.alpha1 > SMALLEST_FALL * scales.level
    return result if falls and _gained(best, result) else None


def _gained(without: Fit, fall: Fit) -> bool:
    """Whether squares decrease by more than chance explains."""
    return bool(np.exp(0.5 * (fall.cost - without.cost) / fall.inflation) < BY_CHANCE)


def _best_falls(cut: Segmented, about: Fit, scales: Scales) -> list[AxisModel]:
    """Models that explain most segments after a step of all other unknowns."""
    project = projection(cut, about)
    samples = cut.lengths

    def unexplained(model: AxisModel) -> float:
        return float(np.sum(samples * np.log1p(project(model) / samples)))

    best = []
    for models in _falls(about.model, scales):
        costs = [unexplained(model) for model in models]
        best.append((min(costs), models[int(np.argmin(costs))]))
    best.sort(key=lambda each: each[0])
    return [model for _, model in best[:MOST_FALLS]]


def fit_with_fall(cut: Segmented, about: Fit, model: AxisModel, scales: Scales) -> Fit:
    """The fit from a model; a fall that is over at once is held, because squares are its stairs."""
    names = [name for name in about.unknowns.names if name not in FALL]
    more = FALL if model.stribeck_velocity > 2.0 * AT_ONCE * scales.speed else ()
    every = unknowns((*names, *more), scales, model)
    return fit(cut, model, every, about.state.first, COARSE)


def _falls(model: AxisModel, scales: Scales) -> Iterable[list[AxisModel]]:
    """Groups of models with other falls: about the one that the model has, or of each velocity."""

    def fallen(excess: float, velocity: float) -> AxisModel:
        return model._replace(alpha1=excess, stribeck_velocity=velocity)

    if model.alpha1:
        velocity = model.stribeck_velocity
        at_once = velocity <= 2.0 * AT_ONCE * scales.speed
        yield [fallen(k * model.alpha1, velocity) for k in NEAR if k != 1.0]
        for factor in () if at_once else (0.5, 2.0):
            yield [fallen(k * model.alpha1, factor * velocity) for k in NEAR]
        return
    for relative in STRIBECK:
        excesses = FINELY if relative == 0.0 else EXCESSES
        velocity = max(relative, AT_ONCE) * scales.speed
        yield [fallen(excess * scales.level, velocity) for excess in excesses]


def stiction_error(cut: Segmented, best: Fit) -> float:
    """Standard error of a fall that is over at once.

    It has three parts: how far the segments do not contradict it, how it changes without one of
    them, and the noise of the torque, whose largest values seem to break the axis away too early.
    """
    project, fall, factors = projection(cut, best), best.model.alpha1, np.sort(NEAR)
    squares = np.array([project(best.model._replace(alpha1=k * fall)) for k in factors])
    whole, count = squares.sum(axis=1), squares.shape[1]
    inside = np.flatnonzero(whole <= whole.min() + HIDDEN * best.inflation)
    low, high = factors[max(inside[0] - 1, 0)], factors[min(inside[-1] + 1, len(factors) - 1)]
    without = factors[np.argmin(whole - squares.T, axis=1)]
    own = fall * np.hypot(0.25 * (high - low), np.sqrt(count - 1.0) * np.std(without))
    jumps = np.median(np.abs(np.diff(cut.data.torque, n=3)))
    return float(np.hypot(own, LARGEST_NOISE * jumps / (0.6745 * np.sqrt(20.0))))


def largest_hidden_fall(cut: Segmented, best: Fit, scales: Scales) -> float:
    """The largest stiction above the Coulomb level that the segments do not contradict."""
    project = projection(cut, best)
    allowed = project(best.model).sum() + HIDDEN * best.inflation
    models = [
        best.model._replace(alpha1=excess * scales.level, stribeck_velocity=AT_ONCE * scales.speed)
        for excess in FINELY
    ]
    return max([m.alpha1 for m in models if project(m).sum() <= allowed], default=0.0)
