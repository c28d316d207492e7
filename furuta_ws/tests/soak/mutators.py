"""Makes random input: messages, parameters and bytes, valid or damaged."""

from math import inf, isfinite, isnan, nan
from typing import Any, NamedTuple

import numpy as np
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from furuta_model.parameters import Declared, declared
from furuta_ros.topics import JOINTS

Random = np.random.Generator

NOT_FINITE = (nan, inf, -inf)
ENORMOUS = (1e300, -1e300, 1.7976931348623157e308, 1e30, -1e20)


class Given(NamedTuple):
    """A message with its kind, and whether it must be refused (None: both are correct)."""

    message: Any
    kind: str
    refuse: bool | None


def pick(random: Random, choices: Any) -> Any:
    """One of the choices."""
    return choices[int(random.integers(len(choices)))]


def joint_state(x: np.ndarray, effort: float, stamp: int) -> JointState:
    """A valid message with state ``x`` (4,) and the arm's effort [V], stamped in ns."""
    message = JointState(
        name=JOINTS,
        position=[float(x[0]), float(x[2])],
        velocity=[float(x[1]), float(x[3])],
        effort=[effort, 0.0],
    )
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 10**9)
    return message


def damaged_joint_state(random: Random, message: JointState, sensors: bool) -> Given:
    """Damage a valid message; with ``sensors`` it is a measurement, which has a range."""
    kind = pick(random, ("not finite", "enormous", "length", "names", "stamp", "stray"))
    refuse: bool | None = True
    if kind in ("not finite", "enormous"):
        value = pick(random, NOT_FINITE if kind == "not finite" else ENORMOUS)
        field, at = pick(random, (("position", 0), ("position", 1), ("velocity", 0)))
        getattr(message, field)[at] = value
        # A reading is replaced; an estimate may be unknown (NaN).
        refuse = not (sensors or isnan(value))
    elif kind == "length":
        field = pick(random, ("position", "velocity", "effort"))
        size = pick(random, (0, 1, 3, 50))
        setattr(message, field, [0.1] * size)
        refuse = None if field == "effort" and size == 0 else True
    elif kind == "names":
        message.name = pick(
            random, (["arm"], [], ["arm", "leg"], ["x" * 1000, "pendulum"], ["", ""])
        )
    elif kind == "stamp":
        message.header.stamp.sec = int(pick(random, (0, -1, 2**31 - 1, -(2**31), 12345)))
        message.header.stamp.nanosec = int(pick(random, (0, 999_999_999, 2**32 - 1)))
        refuse = None
    else:
        message.position = [float(v) for v in random.normal(0, 2, 2)]
        refuse = None
    return Given(message, kind, refuse)


def random_float(random: Random, valid: float = 1.0) -> Given:
    """A message with a number: usual, not finite or enormous."""
    kind = pick(random, ("valid", "valid", "not finite", "enormous", "stray"))
    value = {
        "valid": lambda: float(random.normal(0, valid)),
        "not finite": lambda: pick(random, NOT_FINITE),
        "enormous": lambda: pick(random, ENORMOUS),
        "stray": lambda: float(random.normal(0, 50 * valid)),
    }[kind]()
    refuse = kind in ("not finite", "enormous")
    return Given(Float64(data=value), kind, refuse)


class Change(NamedTuple):
    """Parameters to set, and whether they must be refused (None: both are correct)."""

    parameters: list[Parameter]
    refuse: bool | None


def random_change(random: Random, group: Any) -> Change:
    """A change of one to three parameters of a group, of which one may be bad."""
    known = [each for each in declared(group) if not each.about.read_only]
    chosen = {each.name: each for each in (pick(random, known) for _ in range(3))}
    parameters = [Parameter(name, value=_valid_value(random, e)) for name, e in chosen.items()]
    kind = pick(random, ("valid", "range", "not finite", "type", "unknown"))
    if kind == "valid":
        return Change(parameters, None)  # several values can contradict each other
    bad = _bad_parameter(random, kind, known)
    parameters = [*(each for each in parameters if each.name != bad.name), bad]
    return Change(parameters, True)


def default_values(group: Any) -> Change:
    """A change that sets all parameters of a group to their defaults."""
    known = [each for each in declared(group) if not each.about.read_only]
    parameters = [Parameter(e.name, value=e.default) for e in known if e.kind is not list]
    return Change(parameters, False)


def _valid_value(random: Random, each: Declared) -> Any:
    about = each.about
    if about.choices:
        return pick(random, about.choices)
    if each.kind is bool:
        return bool(random.integers(2))
    if each.kind is list:
        return [float(v) for v in random.normal(0, 5, 4)]
    if each.kind is str:
        return each.default
    low = about.low if isfinite(about.low) else -100.0
    high = about.high if isfinite(about.high) else 100.0
    edge = random.random()
    value = low if edge < 0.05 else high if edge < 0.1 else each.default * random.lognormal(0, 0.5)
    value = min(max(value, low), high)
    return round(value) if each.kind is int else float(value)


def _bad_parameter(random: Random, kind: str, known: list[Declared]) -> Parameter:
    if kind == "unknown":
        return Parameter(pick(random, ("sigma9", "alpha_0", "", "gain.", "π")), value=1.0)
    numbers = [each for each in known if each.kind is float]
    chosen: Declared = pick(random, numbers)
    if kind == "range":
        bounded = [e for e in numbers if isfinite(e.about.high) or isfinite(e.about.low)]
        chosen = pick(random, bounded)
        about = chosen.about
        value = about.high * 2 + 1 if isfinite(about.high) else about.low - 1
        return Parameter(chosen.name, value=float(value))
    if kind == "not finite":
        return Parameter(chosen.name, value=pick(random, NOT_FINITE))
    return Parameter(chosen.name, value=pick(random, ("0.1", True, 7, [0.1], [b"\x01"], ["a"])))
