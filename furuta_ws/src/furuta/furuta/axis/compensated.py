"""A PD loop whose Coulomb friction is compensated too little, exactly, or too much."""

from __future__ import annotations

from typing import Any

from furuta.axis.axis import Axis, Pid, released, servo_joint
from furuta.limit_cycles.joint import JointCycle, joint_cycle
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import ParameterError


def compensated_cycle(axis: Axis, pid: Pid, compensation: float) -> JointCycle:
    """The final motion under PD with the compensation c α₀ sgn(v).

    What remains of friction is (1 − c) α₀ while the axis slides, and c α₀ less than static friction
    while it sticks. It is released where it would be without compensation.

    Raises:
        ParameterError: The controller has an integral, or the law depends on the speed.
    """
    if pid.ki or axis.law not in ("coulomb", "stiction"):
        raise ParameterError(
            f"compensation is analysed under PD and coulomb or stiction, given {pid} and {axis.law}"
        )
    left = axis.friction._replace(alpha0=(1.0 - compensation) * axis.friction.alpha0)
    # What remains may be no friction: the units are those of the axis without compensation.
    given = servo_joint(axis._replace(friction=left), pid).in_units(servo_joint(axis, pid).units)
    return joint_cycle(given, released(axis, pid, len(given.loop.b)))


EXAMPLE = Axis(1.0, Friction(alpha0=1.0, alpha1=0.0), "stiction")
GAINS = Pid(4.0, 0.0, 1.0)
COMPENSATIONS = (0.5, 0.75, 0.9, 1.0, 1.1, 1.25, 1.5)
STATIC = (1.0, 1.2, 1.5, 2.0)  # static over Coulomb friction


def compensation_map() -> tuple[list[dict[str, Any]], bool]:
    """Peak to peak over compensation and static friction; whether only too much of it cycles."""
    rows, held = [], True
    for compensation in COMPENSATIONS:
        row: dict[str, Any] = {"compensation": compensation}
        for ratio in STATIC:
            friction = EXAMPLE.friction._replace(alpha1=ratio - 1.0)
            cycle = compensated_cycle(EXAMPLE._replace(friction=friction), GAINS, compensation)
            cycles = cycle.kind == "limit_cycle"
            row[f"static {ratio:g}"] = cycle.peak_to_peak if cycles else cycle.kind
            held = held and (compensation > 1.0 or not cycles)
        rows.append(row)
    return rows, held and rows[-1]["static 1"] != "rest"
