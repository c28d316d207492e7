"""What a model says: values with standard errors, reasons for those withheld, fits, verdict."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from furuta.identification.model import Model, Prediction
from furuta.identification.regression.windows import coloured_part
from furuta.identification.shooting.unknowns import FRICTION, LUGRE, wave
from furuta.identification.uncertainty.identifiability import (
    AT_END,
    LARGEST_RELATIVE_ERROR,
    undetermined,
)
from furuta.identification.unknowns import field_of, name_of
from furuta.identification.verdict import NO, YES, Residual, Verdict
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import CHANNELS

# Duration [s] at the start over which the fit is given too.
FIRST_SECONDS = 3.0
# Units of values whose name has none.
UNITS = {
    **dict.fromkeys(("alpha", "beta", "gamma"), "V s²/rad"),
    "delta": "V/rad",
    **dict.fromkeys(("a23", "a43"), "1/s²"),
    **dict.fromkeys(("b21", "b41"), "rad/(V s²)"),
    **dict.fromkeys(("viscous", "pendulum_viscous", "sigma1"), "V s/rad"),
    **dict.fromkeys(("coulomb", "pendulum_coulomb", "alpha0", "alpha1", "ceiling"), "V"),
    "stribeck_velocity": "rad/s",
    "sigma0": "V/rad",
    **dict.fromkeys(("delay", "lag"), "s"),
    **dict.fromkeys(("zero", "tilt_x", "tilt_y"), "rad"),
}
# Part [%] of the residuals' autocorrelations outside the band of white noise from which they are an
# error of the model.
CLEARLY_COLOURED = 50.0
# Change of a derived value over that of an unknown's logarithm, as a part of the value, from which
# it is withheld with an unknown that is at the end of its range.
LARGEST_EFFECT = 0.1
# A joint's fit is that of the first of its channels that was measured.
JOINTS = {"arm": ("arm_speed", "arm_angle"), "pendulum": ("pendulum_angle",)}


def reported_values(model: Model) -> dict[str, float]:
    """Every value of the model by name, whether the data determine it or not."""
    values = model.values
    return {
        **_body_values(values.body),
        **{name: values[name] for name in FRICTION},
        **{name: values[name] for name in (*LUGRE, "lag", "tilt_x", "tilt_y", "ceiling")},
        "zero": float(np.mean(_zeros(model))),
        "delay": values["delay"] + model.command_delay,
    }


def _zeros(model: Model) -> list[float]:
    """The pendulum's zero in each recording [rad]."""
    return [model.values.zero(recording.number) for recording in model.recordings]


def _body_values(body: FurutaPendulum) -> dict[str, float]:
    a, b = linearize(body)
    return {
        **body._asdict(),
        "a23": float(a[PHI_DOT, THETA]),
        "a43": float(a[THETA_DOT, THETA]),
        "b21": float(b[PHI_DOT]),
        "b41": float(b[THETA_DOT]),
        "natural_frequency_rad_s": float(np.sqrt(body.delta / body.beta)),
    }


def standard_errors(model: Model) -> dict[str, float]:
    """Standard error of each of :func:`reported_values`."""
    return {
        name: float(np.sqrt(max(0.0, row @ model.covariance @ row)))
        for name, row in _slopes(model).items()
    }


def _slopes(model: Model) -> dict[str, np.ndarray]:
    """Slopes of each of :func:`reported_values` in the unknowns."""
    vector = model.values.vector(model.keys)
    base = reported_values(model)
    slopes: dict[str, list[float]] = {name: [] for name in base}
    for index in range(len(vector)):
        step = 1e-6 * max(1.0, abs(vector[index]))
        changed = vector.copy()
        changed[index] += step
        there = reported_values(model._replace(values=model.values.changed(model.keys, changed)))
        for name, value in there.items():
            slopes[name].append((value - base[name]) / step)
    return {name: np.array(row) for name, row in slopes.items()}


def withheld(model: Model) -> dict[str, str]:
    """Values that the data do not determine, derived ones included, each with the reason."""
    reasons = undetermined(model)
    derived = {n: row for n, row in _slopes(model).items() if n in _body_values(model.values.body)}
    reasons |= {n: why for n, row in derived.items() if (why := _derived_reason(model, n, row))}
    of_zeros = [name_of(key) for key in model.keys if field_of(key) == "zero"]
    zeros = [reasons[name] for name in of_zeros if name in reasons]
    return reasons | ({"zero": zeros[0]} if zeros else {})


def _derived_reason(model: Model, name: str, slopes: np.ndarray) -> str:
    """Why the data do not determine a value of the body, by its ``slopes`` in the unknowns.

    The covariance of an unknown at the end of its range does not hold.
    """
    size = abs(reported_values(model)[name])
    error = float(np.sqrt(max(0.0, slopes @ model.covariance @ slopes)))
    for index, reason in enumerate(undetermined(model).get(name_of(key), "") for key in model.keys):
        if reason.startswith(AT_END) and abs(slopes[index]) > LARGEST_EFFECT * size:
            return f"it depends on {name_of(model.keys[index])}: {reason}"
    if error <= LARGEST_RELATIVE_ERROR * size:
        return ""
    parts = np.abs(slopes) * np.sqrt(np.diag(model.covariance))
    return f"its error is {error:.2g}, mostly from {name_of(model.keys[int(np.argmax(parts))])}"


def values_by_name(model: Model) -> dict[str, Any]:
    """Everything by name, with its unit; None where the data do not determine a value."""
    reasons, errors = withheld(model), standard_errors(model)
    values: dict[str, float | None] = {**reported_values(model)}
    values |= dict.fromkeys(reasons.keys() & values.keys())
    if np.isinf(model.values["ceiling"]):
        values["ceiling"] = None

    def chosen(*names: str) -> dict[str, float | None]:
        return {name: values[name] for name in names}

    return {
        **chosen(*_body_values(model.values.body), *FRICTION),
        "lugre": {"alpha0": values["coulomb"], **chosen(*LUGRE)},
        "setup": {
            **chosen("delay", "lag", "zero", "tilt_x", "tilt_y", "ceiling"),
            "zeros": dict(zip([r.name for r in model.recordings], _zeros(model), strict=True)),
        },
        "waves": _waves(model, reasons),
        "standard_errors": {n: None if n in reasons else e or None for n, e in errors.items()},
        "undetermined": reasons,
        "units": UNITS,
        "findings": model.findings,
        "window_s": None if np.isinf(model.window) else model.window,
    }


def _waves(model: Model, reasons: dict[str, str]) -> list[dict[str, float | None]]:
    """Order, cosine and sine amplitude [V] of each wave of the torque, with standard errors."""
    waves = []
    for order in model.values.wave_orders:
        row: dict[str, float | None] = {"order": order}
        for key in wave(order):
            part, known = field_of(key), key in model.keys and name_of(key) not in reasons
            variance = np.diag(model.covariance)[model.keys.index(key)] if known else np.nan
            row[part] = model.values[key] if known else None
            row[f"{part}_error"] = float(np.sqrt(variance)) if known else None
        waves.append(row)
    return waves


def verdict_on(model: Model, predictions: Sequence[Prediction]) -> Verdict:
    """Whether a model that predicts its own recordings so is usable."""
    return Verdict.of([*_poor_fits(predictions), *_without_inertias(model)])


def _without_inertias(model: Model) -> Iterator[tuple[str, str]]:
    """A model is of no use if no coefficient of its body is determined.

    States that are free at the start of each segment can follow a motion without any command.
    """
    if set(FurutaPendulum._fields) <= withheld(model).keys():
        yield NO, "no coefficient of the body is determined by the data"


def fits(prediction: Prediction) -> dict[str, float]:
    """Fit [%] of each channel, of the pendulum also at the start."""
    whole = {name.replace(" ", "_"): value for name, value in prediction.fits().items()}
    first = prediction.fits(FIRST_SECONDS)["pendulum angle"]
    return {**whole, "pendulum_angle_first_3_s": first}


def verdict(predictions: Sequence[Prediction]) -> Verdict:
    """Whether a model that predicts so is usable."""
    return Verdict.of(_poor_fits(predictions))


def _poor_fits(predictions: Sequence[Prediction]) -> Iterator[tuple[str, str]]:
    """Joints that are not followed."""
    for name, joint, residual in residuals(predictions):
        if residual.grade != YES:
            _, *coloured_residuals = residual.of.split(",")
            why = f"{name}: fit of the {joint} {100.0 * (1.0 - residual.part):.0f} %"
            yield residual.grade, why + ", coloured residuals" * bool(coloured_residuals)


def residuals(predictions: Sequence[Prediction]) -> Iterator[tuple[str, str, Residual]]:
    """What is left of each recording's joints, which are named.

    White residuals have 5 % of their autocorrelations outside the band. More show what the model
    lacks: the standard errors count for that, a noise model would not.
    """
    for prediction in predictions:
        percent, colours = fits(prediction), coloured(prediction)
        for joint, channels in JOINTS.items():
            known = [name for name in channels if not np.isnan(percent[name])]
            if known:
                lasting = ", coloured" * (colours[known[0]] > CLEARLY_COLOURED)
                left = Residual(f"free run{lasting}", np.inf, 1.0 - 0.01 * percent[known[0]])
                yield prediction.recording.name, joint, left


def coloured(prediction: Prediction) -> dict[str, float]:
    """Part [%] of the residuals' first autocorrelations outside the band of white noise."""
    residuals = prediction.recording.measured - prediction.predicted
    return {
        name.replace(" ", "_"): coloured_part(residuals[:, k]) for k, name in enumerate(CHANNELS)
    }
