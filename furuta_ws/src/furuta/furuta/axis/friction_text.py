"""The friction of an axis, from a text."""

from math import isfinite

from furuta_model.friction.laws import find_law
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError

# No friction; what a law needs beside α₀ is given.
NOTHING = Friction(alpha0=0.0, alpha1=0.0)


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
