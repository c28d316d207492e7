"""Friction as a text that a user types."""

from furuta_model.friction.laws import check_friction, falls, find_law
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError


def friction_from_text(text: str, law: str) -> Friction:
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
        try:
            given[name] = float(value)
        except ValueError:
            raise ParameterError(f"{name} must be a number, given {value!r}") from None
    needed = ["alpha0"]
    if given.get("alpha1") and falls(law):
        needed.append("stribeck_velocity")
    if find_law(law).bristle:
        needed.append("sigma0")
    missing = [name for name in needed if not given.get(name)]
    if missing:
        raise ParameterError(f"friction of the law {law} needs {', '.join(missing)} above 0")
    friction = Friction(**{"alpha0": 0.0, "alpha1": 0.0, "sigma1": 0.0, **given})
    check_friction(law, friction)
    return friction
