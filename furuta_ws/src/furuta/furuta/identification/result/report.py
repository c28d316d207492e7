"""Reports a model: values with standard errors, reasons for those withheld, fits, verdict."""

from collections.abc import Iterable, Iterator
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
from furuta.identification.verdict import DOUBTFUL, NO, Verdict
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI_DOT, THETA, THETA_DOT
from furuta_recordings.recording import CHANNELS

# Duration [s] at the start over which the fit is given too.
FIRST_SECONDS = 3.0
# Fit [%] of a joint below which the parameters are meaningless, and below which they are doubtful.
SMALLEST_FIT, DOUBTFUL_FIT = 50.0, 80.0
# Part [%] of the residuals' autocorrelations outside the band of white noise from which they are an
# error of the model, and the fit [%] below which such an error makes the parameters doubtful.
CLEARLY_COLOURED, DOUBTFUL_COLOURED_FIT = 50.0, 95.0
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


def summary(model: Model) -> dict[str, Any]:
    """Everything as one object; None where the data do not determine a value."""
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


def full_report(
    model: Model, fitted: list[Prediction], held_out: list[Prediction]
) -> dict[str, Any]:
    """The :func:`summary` of a model with its fits and the verdict."""
    return {
        **summary(model),
        "fit": {p.recording.name: _fits(p) for p in fitted},
        "held_out": {p.recording.name: _fits(p) for p in held_out},
        "verdict": judged(fitted, _without_inertias(model)),
    }


def judged(predictions: list[Prediction], doubts: Iterable[tuple[str, str]] = ()) -> dict[str, Any]:
    """The verdict, and the coloured part of the residuals [%]."""
    return {
        **Verdict.of([*_poor_fits(predictions), *doubts])._asdict(),
        "coloured_percent": {p.recording.name: _colours(p) for p in predictions},
    }


def _without_inertias(model: Model) -> Iterator[tuple[str, str]]:
    """A model is of no use if no coefficient of its body is determined.

    States that are free at the start of each segment can follow a motion without any command.
    """
    if set(FurutaPendulum._fields) <= withheld(model).keys():
        yield NO, "no coefficient of the body is determined by the data"


def _fits(prediction: Prediction) -> dict[str, float]:
    fits = {name.replace(" ", "_"): value for name, value in prediction.fits().items()}
    first = prediction.fits(FIRST_SECONDS)["pendulum angle"]
    return {**fits, "pendulum_angle_first_3_s": first}


def verdict(predictions: list[Prediction]) -> Verdict:
    """Whether a model that predicts so is usable."""
    return Verdict.of(_poor_fits(predictions))


def _poor_fits(predictions: list[Prediction]) -> Iterator[tuple[str, str]]:
    """Joints that are not followed.

    White residuals have 5 % of their autocorrelations outside the band. More show what the model
    lacks: the standard errors count for that, a noise model would not.
    """
    for prediction in predictions:
        fits, colours = _fits(prediction), _colours(prediction)
        for joint, channels in JOINTS.items():
            known = [name for name in channels if not np.isnan(fits[name])]
            coloured = bool(known) and colours[known[0]] > CLEARLY_COLOURED
            if known and fits[known[0]] < (DOUBTFUL_COLOURED_FIT if coloured else DOUBTFUL_FIT):
                why = f"{prediction.recording.name}: fit of the {joint} {fits[known[0]]:.0f} %"
                grade = NO if fits[known[0]] < SMALLEST_FIT else DOUBTFUL
                yield grade, why + ", coloured residuals" * coloured


def _colours(prediction: Prediction) -> dict[str, float]:
    """Part [%] of the residuals' first autocorrelations outside the band of white noise."""
    residuals = prediction.recording.measured - prediction.predicted
    return {
        name.replace(" ", "_"): coloured_part(residuals[:, k]) for k, name in enumerate(CHANNELS)
    }


def verdict_of(result: dict[str, Any]) -> Verdict:
    """That of a report."""
    return Verdict(result["verdict"]["usable"], result["verdict"]["reasons"])


def report_lines(result: dict[str, Any]) -> Iterator[str]:
    """The lines that ``furuta identify`` prints of a :func:`full_report`."""
    yield from _value_lines(result)
    for name, reason in result["undetermined"].items():
        yield f"{name:26} not determined by the data: {reason}"
    for kind in ("fit", "held_out"):
        for recording, fits in result[kind].items():
            yield f"{kind.replace('_', '-')} {recording}: {_percentages(fits, 1)}"
    for row in result["waves"]:
        if row["cos"] is not None and row["sin"] is not None:
            size = np.hypot(row["cos"], row["sin"])
            yield f"torque wave, {row['order']:2d} per turn {size:11.3g} V"
    if "friction_laws" in result:
        yield from _law_lines(result)
    for name, parts in result["verdict"]["coloured_percent"].items():
        yield f"coloured residuals (white: 5 %) {name}: {_percentages(parts, 0)}"
    yield f"usable: {verdict_of(result).sentence()}"
    for finding in result["findings"]:
        yield f"found: {finding}"
    for name in ("figure", "friction_figure", "rig_file"):
        if name in result:
            yield f"{name.replace('_', ' ')}: {result[name]}"


def _value_lines(result: dict[str, Any]) -> Iterator[str]:
    errors = result["standard_errors"]
    for group in (result, result["lugre"], result["setup"]):
        for name, value in group.items():
            if isinstance(value, float) and name in errors:
                error = f"  ± {errors[name]:.2g}" if errors[name] else ""
                yield f"{name:26} {value:12.6g}{error}"


def _law_lines(result: dict[str, Any]) -> Iterator[str]:
    for law in result["friction_laws"]:
        errors = ", ".join(f"{name} {error:.3f}" for name, error in law["errors"].items())
        title = f"{law['law']} ({law['parameters']} parameters)"
        yield f"law {title:31} held-out error over Coulomb's: {errors}"
    yield f"law supported by the data: {result['simplest_adequate_law']}"


def _percentages(values: dict[str, float], digits: int) -> str:
    known = {name: value for name, value in values.items() if not np.isnan(value)}
    return ", ".join(f"{n.replace('_', ' ')} {value:.{digits}f} %" for n, value in known.items())
