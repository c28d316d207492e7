"""Which unknown parameters the data determine."""

import numpy as np

from furuta.identification.model import Model
from furuta.identification.regression.speeds import turns_one_way, with_speeds
from furuta.identification.shooting.optimisation import Optimum
from furuta.identification.shooting.unknowns import (
    LOGARITHMIC,
    LUGRE,
    range_of,
    unknowns_of,
)
from furuta.identification.unknowns import Key, name_of
from furuta_model.state import PHI_DOT

# Largest standard error, as a part of the prior's standard deviation, of an unknown that is added
# to a fit, and of one that is reported.
LARGEST_PART_TO_FIT = 0.3
LARGEST_PART_TO_REPORT = 0.7
# Largest standard error of a logarithm, that is the largest relative one, that is reported.
LARGEST_RELATIVE_ERROR = 0.5
ASSUMED = "the arm turns in one direction only: a smaller command would have the same effect"
NO_EFFECT = "it has no effect on these recordings"
NOT_SEPARABLE = "its effect cannot be separated from that of other parameters"
AT_END = "the fit ends at"
# Standard errors by which a delay is below 0 in a log whose commands are late.
LATE = 2.0
LOGGED_LATE = "the commands are logged later than they act"
# Part of the range within which a value is at its end.
END = 1e-3
REASONS = {
    "asymmetry": "the arm hardly slides, or slides in one direction only",
    "alpha1": "no slow sliding and no slow reversals in the data",
    "stribeck_velocity": "no slow sliding and no slow reversals in the data",
    "sigma0": "no motion of the stuck arm that the sensors resolve",
    "sigma1": "no motion of the stuck arm that the sensors resolve",
}


def identifiable(optimum: Optimum, names: list[str]) -> list[str]:
    """Those of the unknowns ``names`` that the data determine better than their priors.

    The least certain one is assumed, and the rest is judged again: of two whose effects are alike,
    one may be determined once the other is given.
    """
    both = [*optimum.keys, *names]
    spread = unknowns_of(both, optimum.values).all("spread")
    information = optimum.about(names).information
    own, kept = len(optimum.keys), list(range(len(both)))
    while len(kept) > own:
        variances = np.diag(np.linalg.pinv(information[np.ix_(kept, kept)]))
        parts = np.sqrt(np.maximum(variances, 0.0)) / spread[kept]
        worst = own + int(np.argmax(parts[own:]))
        if parts[worst] < LARGEST_PART_TO_FIT:
            break
        del kept[worst]
    return [names[index - own] for index in kept[own:]]


def undetermined(model: Model) -> dict[str, str]:
    """Unknowns that the data do not determine, each with the reason."""
    reasons = {name_of(key): _reason(model, index) for index, key in enumerate(model.keys)}
    missing = {n: REASONS[n] for n in (*LUGRE, "asymmetry") if n not in model.keys}
    delay = model.values["delay"] + model.command_delay
    if "delay" in model.keys:
        k = model.keys.index("delay")
        delay += LATE * float(np.sqrt(model.covariance[k, k]))
    if delay < 0.0:
        reasons["delay"] = LOGGED_LATE
    return {name: reason for name, reason in (reasons | missing).items() if reason}


def _reason(model: Model, index: int) -> str:
    """Why the data do not determine a fitted or assumed unknown; empty if they do."""
    key = model.keys[index]
    if model.information[index, index] == 0.0:
        one_way = all(turns_one_way(recording) for recording in model.recordings)
        return REASONS.get(name_of(key), ASSUMED if one_way else NO_EFFECT)
    about, value = range_of(key), model.values.coordinates[key]
    margin = END * (about.high - about.low)
    # A lower end of 0 is where nature ends too.
    if value > about.high - margin or (about.low != 0.0 and value < about.low + margin):
        return f"{AT_END} {model.values[key]:.3g}, the end of the allowed range"
    error, spread = float(np.sqrt(model.covariance[index, index])), about.spread
    like_the_prior = np.isfinite(spread) and error > LARGEST_PART_TO_REPORT * spread
    usual = 1.0 if key in LOGARITHMIC else max(_usual_size(model, key), abs(value))
    if like_the_prior or error > LARGEST_RELATIVE_ERROR * usual:
        return REASONS.get(name_of(key), NOT_SEPARABLE)
    return ""


def _usual_size(model: Model, key: Key) -> float:
    """Viscous friction [V s/rad] that shapes the motion; infinite for what has a prior."""
    if key == "viscous":
        speeds = [with_speeds(r, 0.0).measured[:, PHI_DOT] for r in model.recordings]
        commands = [r.largest_command for r in model.recordings]
        return max(u / np.max(np.abs(v)) for u, v in zip(commands, speeds, strict=True))
    body = model.values.body
    return 2.0 * float(np.sqrt(body.beta * body.delta)) if key == "pendulum_viscous" else np.inf
