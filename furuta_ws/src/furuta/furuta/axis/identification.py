"""The axis of a recording, and of a text of friction parameters."""

from math import isfinite

from furuta.axis.axis import Axis
from furuta_identification.axis.identify import AxisFit
from furuta_model.friction.laws import LAWS, find_law
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError

# No friction; what a law needs beside α₀ is given.
NOTHING = Friction(alpha0=0.0, alpha1=0.0)


def identified_axis(fit: AxisFit, law: str | None = None) -> Axis:
    """The axis of a fit, without what belongs to the recording: offset and drift.

    Args:
        fit: What :func:`furuta.identify_axis` returned.
        law: A law that truly sticks: coulomb, stiction or stribeck. None takes stribeck, or
            stiction if the recording shows that friction falls at once.

    Raises:
        ParameterError: The law has a bristle, which the recording does not show.
    """
    at_once = "alpha1" in fit.values and "stribeck_velocity" not in fit.values
    law = law or ("stiction" if at_once else "stribeck")
    if law not in LAWS or find_law(law).bristle:
        raise ParameterError(
            f"a recording shows no bristle: the law must be coulomb, stiction or stribeck, given "
            f"{law}"
        )
    known = {name: value for name, value in fit.values.items() if name in Friction._fields}
    if "stribeck_velocity" not in known and law != "stiction":
        known["alpha1"] = 0.0
    return Axis(fit.values["inertia"], NOTHING._replace(**known), law)


def parse_friction(text: str, law: str) -> Friction:
    """The friction that a text NAME=VALUE,... describes; all else is 0.

    Raises:
        ParameterError: A name is unknown, a value not allowed, or one that the law needs missing.
    """
    given = {}
    for part in text.split(","):
        name, _, value = (word.strip() for word in part.partition("="))
        if name not in Friction._fields:
            known = ", ".join(Friction._fields)
            raise ParameterError(f"friction must be NAME=VALUE,... of {known}; given {part!r}")
        given[name] = _number(name, value)
    needed = ["alpha0"]
    if given.get("alpha1") and law in ("stribeck", "lugre"):
        needed.append("stribeck_velocity")
    if find_law(law).bristle:
        needed.append("sigma0")
    missing = [name for name in needed if not given.get(name)]
    if missing:
        raise ParameterError(f"friction of the law {law} needs {', '.join(missing)} above 0")
    return NOTHING._replace(**{"sigma1": 0.0, **given})


def _number(name: str, text: str) -> float:
    """A number of at least 0, or an asymmetry."""
    low, high = (-1.0, 1.0) if name == "asymmetry" else (0.0, 1e12)
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not (isfinite(value) and low <= value <= high):
        raise ParameterError(f"{name} must be {low:g} to {high:g}, given {text!r}")
    return value
