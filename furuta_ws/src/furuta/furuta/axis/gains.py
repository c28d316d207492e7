"""Gains of a controller: their units, and which of them would make a loop stable."""

from __future__ import annotations

from math import log, sqrt
from typing import Any

from furuta.axis.axis import Axis, Cascade, Controller, Pid, poles

# Factors of a gain with which an unstable loop may be stable.
CHANGES = [1.05**k for k in range(-200, 201)]
# Units of the gains per unit of the position, which stands for {q}, and of the torque {f}.
UNITS = {
    Pid: {"kp": "{f}/{q}", "ki": "{f}/({q} s)", "kd": "{f} s/{q}"},
    Cascade: {"position": "1/s", "speed": "{f} s/{q}", "integral": "{f}/{q}"},
}


def per_unit(controller: Controller, size: float) -> Controller:
    """The controller with its gains per ``size`` [rad] of the position."""
    of_position = [name for name, form in UNITS[type(controller)].items() if "{q}" in form]
    return controller._replace(**{name: size * getattr(controller, name) for name in of_position})


def stable_gains(axis: Axis, controller: Controller) -> dict[str, float]:
    """The nearest value of each gain that alone makes the loop stable without friction, if any."""
    found = {}
    for name, given in controller._asdict().items():
        usual = given or sqrt(axis.inertia * controller.stiffness)
        for factor in sorted(CHANGES, key=lambda each: abs(log(each))):
            value = float(f"{factor * usual:.2g}")
            found_poles = poles(axis, controller._replace(**{name: value}))
            if max(found_poles.real) < -1e-3 * min(abs(found_poles)):
                found[name] = value
                break
    return found


def gain_rows(
    controller: Controller,
    quiet: Controller | None,
    units: tuple[str, str],
    recorded: tuple[str, float],
) -> list[dict[str, Any]]:
    """Each gain with its unit, as given and quiet, and per unit of the recorded position.

    Args:
        controller: The given gains.
        quiet: Gains without hunting, if they are known.
        units: Those of position and torque.
        recorded: The unit of the recorded position, and its size in that of position.
    """
    rows = []
    (position, torque), (other, size) = units, recorded
    for name, form in UNITS[type(controller)].items():
        row: dict[str, Any] = {"gain": name, "unit": form.format(q=position, f=torque)}
        values = {"given": getattr(controller, name)}
        if quiet is not None:
            values["quiet"] = getattr(quiet, name)
        row |= values
        if other != position and "{q}" in form:
            row["recorded_unit"] = form.format(q=other, f=torque)
            row |= {f"{kind}_recorded": size * value for kind, value in values.items()}
        rows.append(row)
    return rows
