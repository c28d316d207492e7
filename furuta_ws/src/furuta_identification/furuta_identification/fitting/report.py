"""What was found, in numbers with their uncertainty and in words where the data tell nothing."""

from __future__ import annotations

from typing import Any

import numpy as np

from furuta_identification.fitting.model import Model
from furuta_identification.shooting.unknowns import BY_NAME, FRICTION, LOGARITHMIC, LUGRE
from furuta_model.linear import linearize
from furuta_model.pendulum import FurutaPendulum
from furuta_model.state import PHI_DOT, THETA, THETA_DOT

# Part of the prior's spread, and of the value itself, that an error must be below.
TOLD_BY_DATA = 0.7
LARGEST_RELATIVE = 0.5
HELD = "the arm turns one way only: a smaller command would do the same"
LOST = "its effect is lost in the others'"
REASONS = {
    "asymmetry": "the arm hardly slides, or slides one way only",
    "alpha1": "no slow sliding and no slow reversals in it",
    "stribeck_velocity": "no slow sliding and no slow reversals in it",
    "sigma0": "no motion within the stuck arm's deflection that the sensors resolve",
    "sigma1": "no motion within the stuck arm's deflection that the sensors resolve",
}


def undetermined(model: Model) -> dict[str, str]:
    """Unknowns of which the data tell nothing, each with the reason."""
    found = {}
    for name in BY_NAME:
        if name in model.names:
            place = model.names.index(name)
            error = float(np.sqrt(model.covariance[place, place]))
            unknown = BY_NAME[name]
            held = model.information[place, place] == 0.0
            vague = np.isfinite(unknown.spread) and error > TOLD_BY_DATA * unknown.spread
            vague = vague or (name in LOGARITHMIC and error > LARGEST_RELATIVE)
            if held or vague:
                found[name] = HELD if held else REASONS.get(name, LOST)
        elif name in LUGRE or name == "asymmetry":
            found[name] = REASONS[name]
    return found


def values(model: Model) -> dict[str, float]:
    """Every number of the model by name, whether the data tell it or not."""
    guess, body = model.guess, model.guess.body
    return {
        **_of_body(body),
        **{name: guess[name] for name in FRICTION},
        **{name: guess[name] for name in (*LUGRE, "lag", "zero", "tilt_x", "tilt_y")},
        "delay": guess["delay"] + model.shift,
    }


def _of_body(body: FurutaPendulum) -> dict[str, float]:
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
    """Standard error of each of :func:`values`, by the slopes of each in the unknowns."""
    vector = model.guess.vector(model.names)
    base = values(model)
    slopes: dict[str, list[float]] = {name: [] for name in base}
    for place in range(len(vector)):
        step = 1e-6 * max(1.0, abs(vector[place]))
        moved = vector.copy()
        moved[place] += step
        there = values(model._replace(guess=model.guess.changed(model.names, moved)))
        for name, value in there.items():
            slopes[name].append((value - base[name]) / step)
    return {
        name: float(np.sqrt(max(0.0, np.array(row) @ model.covariance @ np.array(row))))
        for name, row in slopes.items()
    }


def summary(model: Model) -> dict[str, Any]:
    """All of it as one object; null where the data tell nothing (see ``undetermined``)."""
    number, errors, unknown = values(model), standard_errors(model), undetermined(model)

    def told(name: str) -> float | None:
        return None if name in unknown else number[name]

    body = [*_of_body(model.guess.body)]
    dead = {name for name in number if name in unknown or errors[name] == 0.0}
    return {
        **{name: told(name) for name in body},
        **{name: told(name) for name in FRICTION},
        "lugre": {"alpha0": told("coulomb"), **{name: told(name) for name in LUGRE}},
        "setup": {name: told(name) for name in ("delay", "lag", "zero", "tilt_x", "tilt_y")},
        "standard_errors": {n: None if n in dead else errors[n] for n in errors},
        "undetermined": unknown,
        "findings": model.findings,
        "window_s": None if np.isinf(model.window) else model.window,
    }


def node_parameters(model: Model) -> dict[str, dict[str, Any]]:
    """A parameter file's content: the rig for plant, observer and controller."""
    unknown = undetermined(model)
    body = model.guess.body._asdict()
    friction = model.guess.friction._asdict()
    friction["viscous"] = max(0.0, friction["viscous"])
    for name in LUGRE:
        if name in unknown:
            del friction[name]
    if "alpha1" in unknown:
        # Without a measured stiction none is compensated.
        friction["alpha1"] = 0.0
    plain = {name: float(value) for name, value in friction.items()}
    body = {name: float(value) for name, value in body.items()}
    return {
        "plant": {"ros__parameters": {"model": body, "friction": plain}},
        "friction_observer": {"ros__parameters": plain},
        "controller": {"ros__parameters": {"model": body}},
    }
