"""From recordings to a model: regression, then output error over ever longer stretches."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, PHI_DOT, THETA

from .momentum import MomentumFit, momentum_fit, speed_lag, with_speeds
from .preparation import Options, noise_of, prepare
from .quality import pendulum_fit
from .record import Recording
from .ripple import strongest_order
from .shooting import Shooting, stretches
from .uncertainty import prior, uncertainty
from .unknowns import BODY, BY_NAME, FRICTION, LUGRE, PLACE, RIPPLE, SETUP, TIMING, Guess

# Stretch [s] that is short against the unstable pole, and one long against noise.
SHORT = 0.5
# Stretches [s] over which a swinging pendulum is followed, one after the other: the longer one is,
# the nearer a start must be.
LADDERS = ((0.5, 1.5, np.inf), (0.3, 0.6, 1.2, 2.4, np.inf), (0.5, np.inf))
# Pendulum angle [rad] within which it was balanced, not swinging.
BALANCED = 0.7
# Arm travel [rad] from which a tilted base shows.
TRAVEL = 1.0
# Samples in a row that tell as much as one where the model's errors, not noise, are left.
CORRELATED = 100.0
ROUNDS = 3
# Coulomb friction as a part of the largest command, where the data cannot tell.
USUAL_COULOMB = 0.03


class Model(NamedTuple):
    """What was found.

    ``names`` the unknowns fitted, ``covariance`` of their vector, ``information`` the data's own
    part of its inverse; ``window`` [s] infinite for free runs; ``regression`` the first step.
    """

    guess: Guess
    names: list[str]
    covariance: np.ndarray
    information: np.ndarray
    window: float
    scale: np.ndarray
    regression: MomentumFit
    recordings: list[Recording]
    findings: list[str]


def identify(recordings: list[Recording], options: Options) -> Model:
    """Fit one model to all recordings; raises :class:`ParameterError` where that cannot be done."""
    findings: list[str] = []
    prepared = []
    for each in recordings:
        ready, found = prepare(each, options)
        prepared.append(ready)
        findings += found
    lag = float(np.median([speed_lag(each) for each in prepared]))
    prepared, regression, found = _regress(prepared, lag)
    findings += found
    guess = _first_guess(regression, lag)
    if all(np.max(np.abs(each.measured[:, THETA])) < BALANCED for each in prepared):
        return _fit_balanced(prepared, guess, regression, findings, options)
    return _fit_swinging(prepared, guess, regression, findings, options)


def _regress(
    recordings: list[Recording], lag: float
) -> tuple[list[Recording], MomentumFit, list[str]]:
    """The best of the recordings' regressions, with the command's sign turned if need be."""
    fits = [momentum_fit(with_speeds(each, lag)) for each in recordings]
    findings = []
    best = min(fits, key=lambda fit: abs(fit.standard_errors[0] / fit.alpha))
    if best.alpha < 0.0:
        recordings = [each._replace(command=-each.command) for each in recordings]
        best = min(
            (momentum_fit(with_speeds(each, lag)) for each in recordings),
            key=lambda fit: abs(fit.standard_errors[0] / fit.alpha),
        )
        findings.append("a positive command turns the arm in its negative direction: sign turned")
    if min(best.alpha, best.beta, best.gamma, best.delta) <= 0.0:
        raise ParameterError(
            f"{', '.join(each.name for each in recordings)}: the motion is not that of a Furuta "
            "pendulum under this command (the regression finds a negative inertia); are joints "
            "and command the right ones?"
        )
    return recordings, best, findings


def _first_guess(fit: MomentumFit, lag: float) -> Guess:
    inertia = max(fit.alpha - fit.gamma**2 / fit.beta, 0.05 * fit.alpha)
    return Guess.of(
        arm_inertia=inertia,
        beta=fit.beta,
        gamma=fit.gamma,
        delta=fit.delta,
        viscous=max(fit.viscous, 0.0),
        coulomb=max(fit.coulomb, 0.0),
        asymmetry=float(np.clip(fit.coulomb_asymmetry, -0.5, 0.5)),
        pendulum_viscous=max(fit.pendulum_viscous, 1e-6 * fit.beta),
        pendulum_coulomb=max(fit.pendulum_coulomb, 0.0),
        lag=lag,
    )


def _fit_balanced(
    recordings: list[Recording],
    guess: Guess,
    regression: MomentumFit,
    findings: list[str],
    options: Options,
) -> Model:
    """Upright: short stretches, the states at their starts unknown, with the bristle's friction."""
    window = options.window or SHORT
    scale = np.median([noise_of(each) for each in recordings], axis=0)
    names = [*BODY, "viscous", "coulomb", "asymmetry", "zero"]
    if guess["lag"] > LAGGING * recordings[0].interval:
        names.append("lag")
    else:
        guess = guess.changed(["lag"], [0.0])
    if all(np.ptp(each.measured[:, PHI]) > TRAVEL for each in recordings):
        names += ["tilt_x", "tilt_y"]
    guess, _, _ = optimise(recordings, names, guess, 0.2 * window, scale)
    names += LUGRE
    guess, _, _ = optimise(recordings, names, guess, 0.5 * window, scale)
    names.append("delay")
    guess, shooting, vector = optimise(recordings, names, guess, window, scale)
    error = np.sqrt(uncertainty(shooting, vector, {})[0][-1, -1])
    if abs(guess["delay"]) < max(3.0 * error, 0.5 * recordings[0].interval):
        findings.append(f"no delay of the command: {guess['delay'] * 1e3:.3f} ms, taken for none")
        names.remove("delay")
        guess = guess.changed(["delay"], [0.0])
        guess, shooting, vector = optimise(recordings, names, guess, window, scale)
    return _model(shooting, vector, window, scale, regression, findings, {})


# A lag longer than this many samples is one; a shorter one may be the sampling itself.
LAGGING = 3.0


def _fit_swinging(
    recordings: list[Recording],
    guess: Guess,
    regression: MomentumFit,
    findings: list[str],
    options: Options,
) -> Model:
    """From hanging: stretches first, then free runs, each channel weighed by what it leaves."""
    window = options.window or np.inf
    scale = np.median([noise_of(each) for each in recordings], axis=0)
    scale = np.maximum(scale, [0.003, 0.03, 0.003, 0.03])
    names = [*BODY, *FRICTION, *TIMING, *SETUP]
    held: dict[str, float] = {}
    if _one_way(recordings):
        names = [name for name in names if name not in ("coulomb", "asymmetry")]
        level = USUAL_COULOMB * max(float(np.max(np.abs(each.command))) for each in recordings)
        held["coulomb"] = level
        guess = guess.changed(["coulomb", "asymmetry"], [level, 0.0])
        findings.append(
            "the arm turns one way only, where Coulomb friction cannot be told from a smaller "
            f"command: taken as {USUAL_COULOMB:.0%} of the largest command, {level:.3g} V, give or "
            "take as much"
        )
    starts = [_climb([each], names, guess, window, scale) for each in recordings]
    scale = np.median([each.scale for each in starts], axis=0)
    # Each recording alone leads near a common optimum; together they might trap each other.
    reached = [
        optimise(recordings, names, start.guess, window, scale, robust=True) for start in starts
    ]
    guess, shooting, vector = min(reached, key=lambda each: _size(each[1], each[2]))
    scale = _residual_scale(shooting, vector)
    guess, shooting, vector = optimise(recordings, names, guess, window, scale, robust=True)
    order, size = strongest_order(shooting, vector)
    if order:
        findings.append(
            f"the motor's torque ripples {order} times a turn ({size:.2f} rad/s in the arm's speed)"
        )
        names += RIPPLE
        guess = guess.changed(["ripple_order"], [order])
        guess, shooting, vector = optimise(recordings, names, guess, window, scale, robust=True)
    told = _told(shooting, vector, [name for name in LUGRE if name not in names])
    if told:
        names += told
        guess, shooting, vector = optimise(recordings, names, guess, window, scale, robust=True)
    model = _model(shooting, vector, window, scale, regression, findings, held)
    return model._replace(covariance=model.covariance + _between(model, starts, held))


# Fit of the pendulum's angle [%] from which no other way to it is looked for.
NEAR = 95.0


class _Start(NamedTuple):
    guess: Guess
    scale: np.ndarray
    size: float


def _climb(
    recordings: list[Recording], names: list[str], guess: Guess, window: float, scale: np.ndarray
) -> _Start:
    """Fit over ever longer stretches, by the ladder that ends nearest to the data."""
    reached: list[_Start] = []
    for ladder in LADDERS:
        step, size = guess, scale
        for horizon in ladder:
            step, shooting, vector = optimise(
                recordings, names, step, min(horizon, window), size, robust=True
            )
            size = _residual_scale(shooting, vector)
        reached.append(_Start(step, size, float(np.sum((size / scale) ** 2))))
        if pendulum_fit(shooting, vector) > NEAR:
            break
    return min(reached, key=lambda each: each.size)


def _told(shooting: Shooting, vector: np.ndarray, names: list[str]) -> list[str]:
    """Those of the unknowns ``names`` that the data know better than their prior."""
    both = [*shooting.names, *names]
    wider = Shooting(shooting.parts, both, shooting.guess.changed(shooting.names, vector))
    slopes = wider.slopes(wider.guess.vector(both))
    _, spread = prior(both)
    errors = np.sqrt(np.diag(np.linalg.pinv(slopes.T @ slopes + np.diag(1.0 / spread**2))))
    return [n for n, e, s in zip(both, errors, spread, strict=True) if n in names and e < TOLD * s]


# Part of its prior's spread within which an unknown must be for the data to have told it.
TOLD = 0.3


def _between(model: Model, starts: list[_Start], held: dict[str, float]) -> np.ndarray:
    """How far each recording's own fit is from the common one: what no noise explains."""
    common = np.array([model.guess.values[PLACE[name]] for name in model.names])
    spread = np.zeros((len(common), len(common)))
    if len(starts) > 1:
        for start in starts:
            off = np.array([start.guess.values[PLACE[name]] for name in model.names]) - common
            off[[name in (*RIPPLE, *LUGRE, *held) for name in model.names]] = 0.0
            spread += np.outer(off, off) / len(starts)
    return spread


def _size(shooting: Shooting, vector: np.ndarray) -> float:
    """Weighted sum of what is left, no residual counting for more than a few."""
    return float(np.sum(np.log1p(shooting.residuals(vector) ** 2)))


def _one_way(recordings: list[Recording]) -> bool:
    """Whether no recording has the arm turn both ways."""
    for each in recordings:
        v = with_speeds(each, 0.0).measured[:, PHI_DOT]
        fast = 0.1 * np.max(np.abs(v))
        if np.any(v > fast) and np.any(v < -fast):
            return False
    return True


def _residual_scale(shooting: Shooting, vector: np.ndarray) -> np.ndarray:
    """What each channel leaves (4,), widened because the samples' errors go together."""
    errors = [
        part.recording.measured - predicted
        for part, predicted in zip(shooting.parts, shooting.predictions(vector), strict=True)
    ]
    size: np.ndarray = np.sqrt(np.nanmean(np.concatenate(errors) ** 2, axis=0))
    size = np.where(np.isfinite(size), size, 1.0)
    return np.maximum(np.sqrt(CORRELATED) * size, 1e-4)


def optimise(
    recordings: list[Recording],
    names: list[str],
    guess: Guess,
    window: float,
    scale: np.ndarray,
    robust: bool = False,
) -> tuple[Guess, Shooting, np.ndarray]:
    """Least squares over the unknowns ``names``; ``robust`` bounds the pull of large residuals."""
    parts = [stretches(each, window, scale, guess) for each in recordings]
    shooting = Shooting(parts, names, guess)
    low = np.array([BY_NAME[name].low for name in names])
    high = np.array([BY_NAME[name].high for name in names])
    mean, spread = prior(names)
    margin = 1e-9 * np.maximum(1.0, high - low)
    best = least_squares(
        lambda x: np.append(shooting.residuals(x), (x - mean) / spread),
        np.clip(guess.vector(names), low + margin, high - margin),
        jac=lambda x: np.vstack((shooting.slopes(x), np.diag(1.0 / spread))),
        bounds=(low, high),
        x_scale="jac",
        loss="soft_l1" if robust else "linear",
        ftol=1e-9,
        xtol=1e-10,
        max_nfev=MOST_ROUNDS,
    )
    return guess.changed(names, best.x), shooting, best.x


MOST_ROUNDS = 40


def _model(
    shooting: Shooting,
    vector: np.ndarray,
    window: float,
    scale: np.ndarray,
    regression: MomentumFit,
    findings: list[str],
    held: dict[str, float],
) -> Model:
    covariance, information = uncertainty(shooting, vector, held)
    guess = shooting.guess.changed(shooting.names, vector)
    recordings = [part.recording for part in shooting.parts]
    return Model(
        guess,
        [*shooting.names, *held],
        covariance,
        information,
        window,
        scale,
        regression,
        recordings,
        findings,
    )
