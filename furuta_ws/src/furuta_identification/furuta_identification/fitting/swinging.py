"""Fit of a pendulum that swings from hanging: stretches first, then free runs."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.model import Model
from furuta_identification.fitting.optimisation import (
    NEAR,
    Fitted,
    misfit,
    optimise,
    residual_scale,
)
from furuta_identification.preparation.preparation import Options
from furuta_identification.regression.momentum import MomentumFit
from furuta_identification.regression.speeds import with_speeds
from furuta_identification.shooting.ripple import strongest_order
from furuta_identification.shooting.shooting import Shooting, stretches
from furuta_identification.shooting.unknowns import (
    BODY,
    BY_NAME,
    FRICTION,
    LUGRE,
    PLACE,
    RIPPLE,
    SETUP,
    TIMING,
    Guess,
)
from furuta_identification.uncertainty.quality import pendulum_fit
from furuta_identification.uncertainty.sensing import noise_of
from furuta_identification.uncertainty.uncertainty import prior, uncertainty
from furuta_model.state import PHI_DOT
from furuta_recordings.recording import Recording

# Stretches [s] over which a swinging pendulum is followed, one after the other: the longer one is,
# the nearer a start must be.
LADDERS = ((0.5, 1.5, np.inf), (0.3, 0.6, 1.2, 2.4, np.inf), (0.5, np.inf))
# Residuals [rad, rad/s] that count as one at first, for a model that still lacks parts.
FIRST_SCALE = (0.003, 0.03, 0.003, 0.03)
# Coulomb friction as a part of the largest command, where the data cannot tell, and at most.
USUAL_COULOMB = 0.03
MOST_COULOMB = 0.25
# Part of what is expected of Coulomb friction below which a fit has found none.
LITTLE = 0.3
# Fit of the pendulum's angle [%] from which no other way to it is looked for.
GOOD = 95.0
# Fit [%] of free runs below which stretches [s] are fitted instead, for a pendulum that tumbles
# over the top is chaotic; and of stretches, below which a model is none.
FOLLOWED, TAMED = 80.0, 1.0
POOR = 50.0
# Part of its prior's spread within which an unknown must be for the data to have told it.
TOLD = 0.3
# Recordings whose own fits the common one is started from.
MOST_STARTS = 2


def fit_swinging(
    recordings: list[Recording],
    guess: Guess,
    regression: MomentumFit,
    findings: list[str],
    options: Options,
) -> Model:
    """Fit free runs of all recordings, each channel weighed by what it leaves."""
    window = options.window or np.inf
    names = [*BODY, *FRICTION, *TIMING, *SETUP]
    names, guess, held, found = _without_coulomb_if_one_way(recordings, names, guess)
    scale = np.median([noise_of(each) for each in recordings], axis=0)
    scale = np.maximum(scale, FIRST_SCALE)
    starts = [_fit_growing_segments(each, names, guess, window, scale) for each in recordings]
    scale = np.median([residual_scale(each.shooting, each.vector) for each in starts], axis=0)
    fitted = _together(recordings, names, starts, window, scale)
    scale = residual_scale(fitted.shooting, fitted.vector)
    fitted = optimise(recordings, names, fitted.guess, window, scale, robust=True, tolerance=NEAR)
    if "coulomb" in names and fitted.guess["coulomb"] < LITTLE * BY_NAME["coulomb"].spread:
        fitted = _with_friction(fitted, recordings, names, window, scale)
    order, size = strongest_order(fitted.shooting, fitted.vector)
    if order:
        found.append(
            f"the motor's torque ripples {order} times a turn ({size:.2f} rad/s in the arm's speed)"
        )
        names = [*names, *RIPPLE]
        fitted = fitted._replace(guess=fitted.guess.changed(["ripple_order"], [order]))
    names = [*names, *_determined_by_data(fitted, [name for name in LUGRE if name not in names])]
    fitted = optimise(recordings, names, fitted.guess, window, scale, robust=True)
    follows = pendulum_fit(fitted.shooting, fitted.vector)
    if follows < FOLLOWED and options.window is None:
        why = f"no free run follows these recordings to the end: run in stretches of {TAMED:g} s"
        tamed = options._replace(window=TAMED)
        return fit_swinging(recordings, guess, regression, [*findings, why], tamed)
    covariance, information = uncertainty(fitted.shooting, fitted.vector, held)
    if follows < POOR:
        found.append(
            "the model does not follow these recordings (the pendulum's angle to "
            f"{follows:.0f} %): its numbers mean nothing"
        )
    return Model(
        fitted.guess,
        [*names, *held],
        covariance + _between(fitted, starts, held),
        information,
        window,
        scale,
        regression,
        recordings,
        [*findings, *found],
    )


def _without_coulomb_if_one_way(
    recordings: list[Recording], names: list[str], guess: Guess
) -> tuple[list[str], Guess, dict[str, float], list[str]]:
    """Names, guess, what is held with its spread, and why, where no recording turns both ways."""
    if not all(_one_way(each) for each in recordings):
        return names, guess, {}, []
    largest = max(float(np.max(np.abs(each.command))) for each in recordings)
    usual = max(USUAL_COULOMB * largest, BY_NAME["coulomb"].spread)
    level = min(usual, MOST_COULOMB * largest)
    why = (
        "the arm turns one way only, where Coulomb friction cannot be told from a smaller "
        f"command: taken as {level:.3g} V, give or take as much"
    )
    kept = [name for name in names if name not in ("coulomb", "asymmetry")]
    return kept, guess.changed(["coulomb", "asymmetry"], [level, 0.0]), {"coulomb": level}, [why]


def _one_way(recording: Recording) -> bool:
    """Whether the arm turns in one direction alone."""
    v = with_speeds(recording, 0.0).measured[:, PHI_DOT]
    fast = 0.1 * np.max(np.abs(v))
    return not (np.any(v > fast) and np.any(v < -fast))


def _fit_growing_segments(
    recording: Recording, names: list[str], guess: Guess, window: float, scale: np.ndarray
) -> Fitted:
    """Fit over ever longer stretches, by the ladder that ends nearest to the data."""
    reached: list[tuple[float, Fitted]] = []
    for ladder in LADDERS:
        step, size = guess, scale
        for horizon in ladder:
            fitted = optimise(
                [recording], names, step, min(horizon, window), size, robust=True, tolerance=NEAR
            )
            step, size = fitted.guess, residual_scale(fitted.shooting, fitted.vector)
        reached.append((float(np.sum((size / scale) ** 2)), fitted))
        if pendulum_fit(fitted.shooting, fitted.vector) > GOOD:
            break
    return min(reached, key=lambda each: each[0])[1]


def _together(
    recordings: list[Recording],
    names: list[str],
    starts: list[Fitted],
    window: float,
    scale: np.ndarray,
) -> Fitted:
    """The best common fit from where each recording alone led.

    Each alone leads near a common optimum; together they might trap each other.
    """
    if len(recordings) == 1:
        return starts[0]

    def before(start: Fitted) -> float:
        parts = [stretches(each, window, scale, start.guess) for each in recordings]
        return misfit(Shooting(parts, names, start.guess), start.vector)

    reached = [
        optimise(recordings, names, start.guess, window, scale, robust=True, tolerance=NEAR)
        for start in sorted(starts, key=before)[:MOST_STARTS]
    ]
    return min(reached, key=lambda each: misfit(each.shooting, each.vector))


def _with_friction(
    fitted: Fitted, recordings: list[Recording], names: list[str], window: float, scale: np.ndarray
) -> Fitted:
    """The better of the fit and one begun with Coulomb friction: a fit without is often a trap."""
    level = BY_NAME["coulomb"].spread
    speeds = np.concatenate([with_speeds(each, 0.0).measured[:, PHI_DOT] for each in recordings])
    instead = fitted.guess["viscous"] - level / float(np.sqrt(np.mean(speeds**2)))
    begun = fitted.guess.changed(["coulomb", "viscous"], [level, max(instead, 0.0)])
    other = optimise(recordings, names, begun, window, scale, robust=True, tolerance=NEAR)
    return min((fitted, other), key=lambda each: misfit(each.shooting, each.vector))


def _determined_by_data(fitted: Fitted, names: list[str]) -> list[str]:
    """Those of the unknowns ``names`` that the data know better than their prior."""
    both = [*fitted.shooting.names, *names]
    wider = Shooting(fitted.shooting.parts, both, fitted.guess)
    slopes = wider.slopes(fitted.guess.vector(both))
    _, spread = prior(both)
    variances = np.diag(np.linalg.pinv(slopes.T @ slopes + np.diag(1.0 / spread**2)))
    errors = np.sqrt(np.maximum(variances, 0.0))
    return [n for n, e, s in zip(both, errors, spread, strict=True) if n in names and e < TOLD * s]


def _between(fitted: Fitted, starts: list[Fitted], held: dict[str, float]) -> np.ndarray:
    """How far the recordings' own fits lie from the common one beyond their own errors.

    What no error of one recording explains is a difference between recordings that the model
    lacks: random effects as in DerSimonian and Laird (1986).
    """
    names = [*fitted.shooting.names, *held]
    spread = np.zeros((len(names), len(names)))
    if len(starts) == 1:
        return spread
    for start in starts:
        one_way = _one_way(start.shooting.parts[0].recording)
        own, _ = uncertainty(start.shooting, start.vector, held)
        beyond = np.zeros(len(names))
        for k, (name, value) in enumerate(zip(start.shooting.names, start.vector, strict=True)):
            if one_way and name in ("coulomb", "asymmetry"):
                continue
            off = value - fitted.guess.values[PLACE[name]]
            beyond[names.index(name)] = np.sign(off) * np.sqrt(max(0.0, off**2 - own[k, k]))
        spread += np.outer(beyond, beyond) / len(starts)
    return spread
