"""The axis of a recording."""

from furuta.axis.axis import Axis
from furuta.axis.friction_text import NOTHING
from furuta_identification.axis.identify import AxisFit
from furuta_model.friction.laws import LAWS, find_law
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError


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
