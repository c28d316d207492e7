"""Which effects a recording supports: each is tested by what the segments say of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from furuta.identification.averaging import (
    ORDERS,
    SURER,
    Averaged,
    Candidate,
    Catalogue,
    Group,
    Model,
    Neighbourhood,
    explained_by,
    log_odds,
    mixture_errors,
    most_probable,
)
from furuta.identification.axis.start import EARLIEST
from furuta.identification.bodies.axis import Axis, wave
from furuta.identification.bodies.body import Segments
from furuta.identification.least_squares import (
    COARSE,
    FINE,
    Fit,
    Linearised,
    Problem,
    Projection,
    fit,
    linearised,
    projection,
)
from furuta.identification.unknowns import Key, Unknown, Unknowns, Values, field_of

# Levels of what stiction adds, relative to the Coulomb level, and Stribeck velocities relative to
# the usual speed, that are tried.
EXCESSES, FINELY = np.geomspace(0.05, 1.5, 9), np.geomspace(0.03, 1.6, 40)
STRIBECK = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
# Standard deviation, before anything is known of it, of an asymmetry, of the drag at the usual
# speed in the friction there, of friction per torque, and of any other effect in the usual torque.
ASYMMETRY, DRAG, LOAD, EFFECT = 0.2, 0.3, 0.1, 1.0
# Usual change of friction per torque.
SIZE_OF_LOAD = 0.05
FALL = ("alpha1", "stribeck_velocity")
# Factors about a fall that is known, and searches for a fall.
NEAR = np.append(1.0, 1.0 + np.outer((-1.0, 1.0), (0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.35)))
FALLS, MOST_FALLS = 3, 2
# Decrease of the cost at which a fit on the way ends, in what is one of independent residuals.
ROUGH = 0.5
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
LOWEST = {"delay": EARLIEST, "alpha0": 0.0, "alpha1": 0.0, "load_friction": 0.0}
POSITIVE, FACTOR = ("inertia", "stribeck_velocity"), 2.5
# Friction in proportion to the torque of the drive. Where it is not found, it is taken to be
# absent: moves at one torque do not tell it from the Coulomb level.
LOADED = "load_friction"
# Effects over the speed that may stand for a fall that has not been looked for yet.
LIKE_A_FALL = ("drag", "viscous_difference")
ALWAYS = ("inertia", "alpha0", "viscous", "delay", "spring", "asymmetry")
GRAVITY = ("gravity_sin", "gravity_cos")


class Scales:
    """Usual torque, friction, speed and travel of the recordings, from which sizes follow.

    ``friction`` is that at the usual speed, of which the ``level`` is the Coulomb friction.
    """

    def __init__(
        self,
        torque: float,
        level: float,
        viscous: float,
        speed: float,
        travel: float,
        length: float,
    ):
        self.torque, self.level, self.speed = torque, max(level, 0.02 * torque), speed
        self.friction = self.level + max(viscous, 0.0) * speed
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
            "viscous_difference": (self.level / self.speed, DRAG * self.friction / self.speed),
            "drag": (self.level / self.speed**2, DRAG * self.friction / self.speed**2),
            "drift": (self.level / self.length, effect / self.length),
            "load_friction": (SIZE_OF_LOAD, LOAD),
            "gravity_friction": (SIZE_OF_LOAD, LOAD),
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


def rough(about: Fit) -> float:
    """Decrease of the cost, in that of a sample, that makes no model more probable."""
    return max(COARSE, ROUGH * about.inflation(SURE) / about.rms**2)


def supported(cut: Segments, base: Fit, scales: Scales, drift: bool) -> Fit:
    """The most probable model that is found by single changes, each refitted.

    A fall of friction is looked for where an effect would be added that may stand for one, and
    after the others.
    """
    catalogue, looked = catalogue_of(drift), list[Fit]()

    def models(best: Fit) -> list[Candidate]:
        return _neighbourhood(cut, best, scales, catalogue).candidates(catalogue)

    def refitted(best: Fit, model: Model) -> Fit:
        keys = model.keys(best.keys)
        gone = [key for key in best.keys if key not in keys]
        values = {**best.values, **dict.fromkeys(gone, 0.0)}
        other = fitted(cut, keys, scales, values, best.state.first, rough(best))
        like_a_fall = any(group[0] in LIKE_A_FALL for group in model.added)
        if like_a_fall and not looked and not best.values["alpha1"]:
            looked.append(best)
            fall = _falling(cut, best, scales)
            return fall if fall is not None and _gained(other, fall) else other
        return other

    best = most_probable(base, models, refitted, SURE)
    for _ in range(FALLS):
        fall = _falling(cut, best, scales)
        if fall is None:
            break
        best = most_probable(fall, models, refitted, SURE)
    best = fitted(cut, best.keys, scales, best.values, best.state.first)
    if not best.values["alpha1"] and FALL[0] not in best.keys:
        return best
    keys, values = _without(best, FALL)
    without = fitted(cut, keys, scales, values, best.state.first, rough(best))
    # What a fall stood for may be another effect.
    without = most_probable(without, models, refitted, SURE)
    return _with_fall_or_without(cut, best, without, scales)


def catalogue_of(drift: bool, loaded: bool = True) -> Catalogue:
    """All effects that an axis may have, friction that grows with the load among them."""
    loads: list[Group] = [("spring",), GRAVITY, *wave_groups()]
    singles = [(name,) for name in (*smooth_effects(drift), *([LOADED] if loaded else ()))]
    return Catalogue([*loads, *singles], loads)


def _neighbourhood(cut: Segments, best: Fit, scales: Scales, catalogue: Catalogue) -> Neighbourhood:
    """The models about a fit."""
    keys = catalogue.keys(best.keys)
    values = {**dict.fromkeys(keys, 0.0), **best.values}
    unknowns = Unknowns(scales.unknown(key, values) for key in keys)
    return Neighbourhood.of(_about(cut, best, keys, scales), unknowns, values, best, SURE)


def averaged_errors(cut: Segments, best: Fit, scales: Scales, drift: bool) -> Averaged:
    """Covariance (p, p) in sizes over all models that explain the segments about as well.

    Of friction that falls at once, ``stiction`` is the standard error.
    """
    catalogue = catalogue_of(drift)
    there = _neighbourhood(cut, best, scales, catalogue)
    found = there.averaged(there.candidates(catalogue))._replace(
        load=SIZE_OF_LOAD * there.hidden_load()
    )
    if not best.values["alpha1"]:
        # A fall is as probable beside each of the models.
        alone = there.candidate(Model((), ()))
        falls = there.averaged([alone, *falls_beside(cut, best, scales, len(there.rows))])
        wider = np.diag(falls.covariance) / np.diag(found.covariance)
        factor = np.sqrt(np.maximum(wider, 1.0))
        return found._replace(covariance=found.covariance * np.outer(factor, factor))
    more, stiction = fall_errors(cut, best, scales)
    return found._replace(covariance=found.covariance + more, stiction=stiction)


def wave_groups() -> list[Group]:
    """Cosine and sine of each wave that an axis may have."""
    return [wave(n) for n in ORDERS]


def waves_of(best: Fit) -> list[Group]:
    """Cosine and sine of each wave that is fitted."""
    return [wave(int(key[1])) for key in best.unknowns.keys if field_of(key) == "cos"]


def _without(best: Fit, dropped: Iterable[Key]) -> tuple[list[Key], Values]:
    """Keys and values of a fit without some of the unknowns, which become 0."""
    keys = [key for key in best.unknowns.keys if key not in set(dropped)]
    return keys, {**best.values, **dict.fromkeys(dropped, 0.0)}


def _with_fall_or_without(cut: Segments, best: Fit, without: Fit, scales: Scales) -> Fit:
    """The fit with a fall that may be over at once, or ``without`` one if that is as probable."""
    if best.values["stribeck_velocity"] < SHORT * scales.speed:
        velocity = AT_ONCE * scales.speed
        best = fit_with_fall(cut, best, {**best.values, "stribeck_velocity": velocity}, scales)
    best = fitted(cut, best.unknowns.keys, scales, best.values, best.state.first)
    falls = best.values["alpha1"] > SMALLEST * scales.level
    return best if falls and _gained(without, best) else without


def _about(cut: Segments, best: Fit, keys: Sequence[Key], scales: Scales) -> Linearised:
    """The problem about a fit with other unknowns."""
    values = {**dict.fromkeys(keys, 0.0), **best.values}
    return linearised(problem_of(cut, keys, scales, values), best.state._replace(values=values))


def smooth_effects(drift: bool) -> tuple[str, ...]:
    """Effects beside those that are always fitted and waves."""
    return ("viscous_difference", "drag", *(("drift",) if drift else ()))


def _falling(cut: Segments, best: Fit, scales: Scales) -> Fit | None:
    """The fit with friction that falls after breakaway, or falls otherwise, if that is probable.

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
        if better.cost > result.cost - rough(result) * result.rms**2:
            break
        result = better
    if best.values["alpha1"]:
        return (
            result if explained_by(best.cost, result.cost, best.inflation(SURE)) > SURER else None
        )
    falls = result.values["alpha1"] > SMALLEST * scales.level
    return result if falls and _gained(best, result) else None


def _gained(without: Fit, wider: Fit) -> bool:
    """Whether a fall is more probable than none: one of those that are tried is as probable."""
    tried = float(np.log(len(STRIBECK) * len(EXCESSES)))
    return explained_by(without.cost, wider.cost, without.inflation(SURE)) > tried


def _projection_of(cut: Segments, best: Fit, which: Sequence[int] | None = None) -> Projection:
    return projection(Problem(Axis(), cut, best.unknowns), best, which)


def _projection(cut: Segments, best: Fit) -> Callable[[Values], np.ndarray]:
    project = _projection_of(cut, best)
    return lambda values: project(values)[0]


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
    return fitted(cut, (*keys, *more), scales, values, about.state.first, rough(about))


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
    for relative in STRIBECK:
        excesses = FINELY if relative == 0.0 else EXCESSES
        velocity = max(relative, AT_ONCE) * scales.speed
        yield [fallen(excess * scales.level, velocity) for excess in excesses]


def falls_beside(cut: Segments, best: Fit, scales: Scales, count: int) -> list[Candidate]:
    """Models (of ``count`` unknowns) that have a fall besides, over at once or of a velocity."""
    project, noise = _projection_of(cut, best), (best.inflation(SURE), best.rms**2, best.cost)
    least, none = float(project(best.values)[0].sum()), Model((), ())
    tried = next(iter(_falls(best.values, scales)))
    sizes = np.log([values[FALL[0]] for values in tried])
    found = []
    for values, part in zip(tried, np.gradient(sizes) / np.ptp(sizes), strict=True):
        squares, step = project(values)
        gained = explained_by(least, float(squares.sum()), noise[0])
        odds = log_odds(FALL[:1]) + float(np.log(part))
        found.append(Candidate(none, step, gained, odds, covered=best.covariance))
    keys, known = (*best.keys, FALL[0]), len(best.unknowns)
    for relative in STRIBECK[1:]:
        values = {**best.values, FALL[1]: relative * scales.speed}
        about = best._replace(state=best.state._replace(values=values))
        unknowns = Unknowns(scales.unknown(key, values) for key in keys)
        linear = _about(cut, about, keys, scales)
        there = Neighbourhood.of(linear, unknowns, values, best, SURE)
        model = Model((), (FALL[:1],))
        each = there.candidate(model)
        covered = there.covariance(model, each.step)
        found.append(each._replace(model=none, step=each.step[:known], covered=covered))
    wider = np.zeros(count - known)
    return [each._replace(step=np.append(each.step, wider)) for each in found]


def fall_errors(cut: Segments, best: Fit, scales: Scales) -> tuple[np.ndarray, float]:
    """Covariance (p, p) in sizes by all falls that explain about as much, and error of stiction.

    A fall of any size is as probable, with any of the velocities that are tried. The largest values
    of the torque's noise seem to break the axis away too early.
    """
    keys, size = best.unknowns.keys, best.unknowns.all("size")
    rows = [k for k, key in enumerate(keys) if key in FALL]
    others = [k for k in range(len(keys)) if k not in rows]
    project = _projection_of(cut, best, others)
    inflation, least = best.inflation(SURE), float(project(best.values)[0].sum())
    here = np.array([best.values[name] for name in FALL])
    if rows:
        own = np.sqrt(np.diag(best.covariance))[rows] * size[rows]
    else:
        jumps = np.median(np.abs(np.diff(cut.data.torque, n=3)))
        noise = LARGEST_NOISE * float(jumps) / (0.6745 * np.sqrt(20.0))
        own = np.array([np.hypot(_error_at_once(best, project), noise), 0.0])
    weights, shifts = [float(own[0] / here[0]) * np.sqrt(2.0 * np.pi)], [np.zeros(2)]
    for tried in _falls(best.values, scales):
        tried.sort(key=lambda values: values[FALL[0]])
        places = np.array([[values[name] for name in FALL] for values in tried])
        gains = [explained_by(least, float(project(v)[0].sum()), inflation) for v in tried]
        weights += list(np.exp(np.minimum(gains, 0.0)) * np.gradient(np.log(places[:, 0])))
        shifts += list(places - here)
    total = np.array(weights) / np.sum(weights)
    errors = mixture_errors(total, np.array(shifts), np.tile(own**2, (len(total), 1)))
    step = np.zeros(len(keys))
    if rows:
        step[rows] = np.maximum(errors**2 - own**2, 0.0) / size[rows] ** 2
        return np.diag(step), 0.0
    step[others] = own[0] * _along(best, project, inflation)
    return np.outer(step, step), float(errors[0])


def _along(best: Fit, project: Projection, inflation: float) -> np.ndarray:
    """How other values (p,) move with stiction, over what the segments do not contradict."""
    near = [{**best.values, FALL[0]: k * best.values[FALL[0]]} for k in NEAR]
    squares, steps = zip(*(project(values) for values in near), strict=True)
    costs = np.array([each.sum() for each in squares])
    gains = [explained_by(costs[0], each, inflation) for each in costs]
    moved = (NEAR - 1.0) * best.values[FALL[0]]
    weighted = np.exp(np.minimum(gains, 0.0)) * moved
    apart = np.array(steps) - steps[0]
    slopes: np.ndarray = weighted @ apart / max(float(weighted @ moved), 1e-300)
    return slopes


def _error_at_once(best: Fit, project: Projection) -> float:
    """Standard error of a fall that is over at once, as the segments contradict each other."""
    fall, factors = best.values[FALL[0]], np.sort(NEAR)
    squares = np.array([project({**best.values, FALL[0]: k * fall})[0] for k in factors])
    without = factors[np.argmin(squares.sum(axis=1) - squares.T, axis=1)]
    return float(fall * np.sqrt(len(without) - 1.0) * np.std(without))


def largest_hidden_fall(cut: Segments, best: Fit, scales: Scales) -> float:
    """The largest stiction above the Coulomb level that the segments do not contradict."""
    project = _projection(cut, best)
    allowed = project(best.values).sum() + HIDDEN * best.inflation(SURE)
    at_once = {**best.values, "stribeck_velocity": AT_ONCE * scales.speed}
    excesses = [excess * scales.level for excess in FINELY]
    hidden = [e for e in excesses if project({**at_once, "alpha1": e}).sum() <= allowed]
    return max(hidden, default=0.0)
