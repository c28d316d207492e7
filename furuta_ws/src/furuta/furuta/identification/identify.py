"""From recordings to a model: preparation, regression, then output error; and its predictions."""

from collections.abc import Sequence

import numpy as np

from furuta.identification.fitting.balanced import LARGEST_ANGLE, SEGMENT, fit_balanced, is_balanced
from furuta.identification.fitting.held_out_ceiling import with_ceiling
from furuta.identification.fitting.swinging import fit_swinging
from furuta.identification.model import Model, Prediction
from furuta.identification.options import Options
from furuta.identification.preparation.prepare import prepare, prepare_all
from furuta.identification.regression.equations import (
    arm_rows,
    command_scales,
    fitted_ceiling,
    has_one_level,
)
from furuta.identification.regression.first_estimate import DELAY_STEP, MomentumFit, first_estimate
from furuta.identification.regression.speeds import speed_lag
from furuta.identification.shooting.unknowns import ParameterValues
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, THETA
from furuta_recordings.recording import Recording, findings_of
from furuta_recordings.splitting import EXCERPT, EXCERPTS, excerpts_of, split_into_runs

# Samples of all recordings from which excerpts are fitted: 30 s at 1 kHz.
MOST_SAMPLES = 30_000
# Samples of a swinging pendulum's recording that are fitted whole; a longer free run is slower to
# fit than excerpts, and more often irregular.
MOST_SWINGING = EXCERPTS * EXCERPT
# Duration [s] at the start over which the pendulum's rest angle is taken.
REST = 0.1
# Largest movement [rad] of a pendulum at rest, and largest deviation [rad] of its angle from the
# rest angle of the model that is not another zero.
LARGEST_ZERO_ERROR = 0.03


def identify(recordings: list[Recording], options: Options) -> Model:
    """Fit one model to all recordings; raises :class:`ParameterError` if that is impossible."""
    if not any(np.any(recording.command) for recording in recordings):
        raise ParameterError(
            f"{recordings[0].name}: the command is 0 throughout; use --command none for a pendulum "
            "that swings freely"
        )
    runs = [run for recording in recordings for run in split_into_runs(recording)]
    most = MOST_SAMPLES // len(runs)
    numbered = (run._replace(number=number) for number, run in enumerate(runs))
    excerpts = [excerpt for run in numbered for excerpt in excerpts_of(run, most)]
    options.report("finding units and orientation")
    ready = prepare_all(excerpts, options)
    findings = findings_of(ready.recordings)
    lag = float(np.median([speed_lag(recording) for recording in ready.recordings]))
    prepared, regression, delay, negated = first_estimate(ready.recordings, lag)
    if negated:
        findings.append("a positive command turns the arm in its negative direction: sign inverted")
    found = _first_ceiling(prepared, lag, delay, options.ceiling or np.inf)
    ceiling = options.ceiling or found
    if np.isfinite(ceiling):
        limited = [recording.with_ceiling(ceiling) for recording in prepared]
        regression = first_estimate(limited, lag).regression
    elif has_one_level(prepared):
        findings.append(
            "the command has one level only, so a drive that reaches less cannot be noticed: all "
            "values in volts would be too large in proportion (state its limit with --ceiling)"
        )
    start = starting_values(regression, lag, ceiling)
    if all(is_balanced(recording) for recording in prepared):
        # In such slow motion the regression hardly distinguishes a delay from an inertia.
        model, delay = fit_balanced(prepared, start, findings, options), 0.0
    else:
        # The rest of the delay, which is fitted, is not negative. Of a short one all is fitted: the
        # search takes the Coulomb friction of an arm that reverses with the command for a delay.
        short = -0.5 * DELAY_STEP < delay < 1.5 * DELAY_STEP
        delay = 0.0 if short else delay - 0.5 * DELAY_STEP
        delayed = [recording.with_delayed_command(delay) for recording in prepared]
        parts = [part for run in delayed for part in excerpts_of(run, MOST_SWINGING)]
        findings = list(dict.fromkeys([*findings, *findings_of(parts)]))
        model = fit_swinging(parts, start, findings, options)
    return model._replace(
        command_negated=negated,
        command_delay=delay,
        angles=ready.angles,
        direction=ready.direction,
    )


def _first_ceiling(recordings: list[Recording], lag: float, delay: float, given: float) -> float:
    """A first value of the ceiling [V]; raises ParameterError if commands have several units.

    A recording in another unit resembles one whose commands are clipped, so the smaller misfit
    decides. The slow motion of balanced pendulums hardly shows a unit.
    """
    rows = arm_rows([recording.with_ceiling(given) for recording in recordings], lag, delay)
    ceiling, misfit = fitted_ceiling(rows)
    other = min(command_scales(rows), key=lambda scale: scale.misfit, default=None)
    swinging = not all(is_balanced(recording) for recording in recordings)
    if swinging and other and other.differs and other.misfit < misfit:
        raise ParameterError(
            f"{other.name}: a command of 1 acts like {other.factor:.3g} ± {other.error:.2g} of the "
            "other recordings, as if in another unit or sign; convert its commands, or identify it "
            f"alone with --command-scale {abs(other.factor):.3g}"
        )
    return ceiling


def starting_values(fit: MomentumFit, lag: float, ceiling: float) -> ParameterValues:
    """Values of the unknowns from a regression, moved into their ranges."""
    return ParameterValues.of(
        arm_inertia=max(fit.alpha - fit.gamma**2 / fit.beta, 0.05 * fit.alpha),
        beta=fit.beta,
        gamma=fit.gamma,
        delta=fit.delta,
        viscous=max(fit.viscous, 0.0),
        coulomb=max(fit.coulomb, 0.0),
        asymmetry=float(np.clip(fit.coulomb_asymmetry, -0.5, 0.5)),
        pendulum_viscous=max(fit.pendulum_viscous, 1e-6 * fit.beta),
        pendulum_coulomb=max(fit.pendulum_coulomb, 0.0),
        lag=lag,
        ceiling=ceiling,
    )


def held_out(model: Model, recordings: Sequence[Recording], options: Options) -> list[Prediction]:
    """What a model predicts of each run of recordings that it was not fitted to."""
    runs = [run for recording in recordings for run in split_into_runs(recording)]
    return [validate(model, run, options) for run in runs]


def validate(model: Model, recording: Recording, options: Options) -> Prediction:
    """Simulate the model along a recording that it was not fitted to.

    The recording has the units of the fitted ones, but its own zero, which a hanging pendulum at
    rest shows.
    """
    options = options._replace(angles=model.angles)
    ready = prepare(recording, options, model.direction)
    if model.command_negated:
        ready = ready.with_command_negated()
    ready = ready.with_delayed_command(model.command_delay)
    if is_balanced(ready):
        return model._replace(window=min(model.window, SEGMENT)).predict(ready)
    zero, error = _own_zero(model, ready)
    if error:
        ready = ready.noting(f"the pendulum's zero differs by {error:.3f} rad: corrected")
    model = model._replace(values=model.values.with_zero(zero))
    return with_ceiling(model, model.predict(ready))


def _own_zero(model: Model, recording: Recording) -> tuple[float, float]:
    """The recording's own zero, and by how much it differs from all fitted ones [rad].

    That is the zero of the nearest fitted recording. If the pendulum hangs at rest at an angle that
    none of them explains, its encoder was started at another angle.
    """
    zeros = [model.values.zero(fitted.number) for fitted in model.recordings]
    first = recording.between(recording.time[0], recording.time[0] + REST).measured
    at_rest = np.ptp(first[:, THETA]) < LARGEST_ZERO_ERROR
    errors = [_zero_error(model, zero, first) for zero in zeros]
    if not (at_rest and min(np.abs(errors)) < LARGEST_ANGLE):
        return float(np.mean(zeros)), 0.0
    best = int(np.argmin(np.abs(errors)))
    error = errors[best] if abs(errors[best]) > LARGEST_ZERO_ERROR else 0.0
    return zeros[best] - error, error


def _zero_error(model: Model, zero: float, first: np.ndarray) -> float:
    """How far a measured rest (n, 4) is from the model's with a ``zero`` [rad].

    Hanging, sinθ ≈ −(θ − π) and cosθ ≈ −1 balance the torque of the tilt.
    """
    values, phi = model.values, float(first[0, PHI])
    deviation = float(np.mean(first[:, THETA])) + zero - np.pi
    expected = values["tilt_y"] * np.cos(phi) - values["tilt_x"] * np.sin(phi)
    return float((deviation - expected + np.pi) % (2 * np.pi) - np.pi)
