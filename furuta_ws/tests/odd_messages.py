"""Messages of any type with one odd field: what a foreign program may publish."""

import re
from array import array
from collections.abc import Iterator
from importlib import import_module
from math import inf, nan
from typing import Any

from rclpy.publisher import Publisher

from furuta_ros.testing import joint_state

# Bytes that are no message.
MALFORMED = (b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"\xff" * 40, b"\xff" * 9)
ODD: dict[str, list[Any]] = {
    "double": [nan, inf, -inf, 1e300, -1e300],
    "float": [nan, inf],
    "boolean": [True, False],
    "string": ["", "x" * 10_000, "☃", "x: rig", "/", "/hardware_bridge", "/plant"],
    "sequence<double>": [[], [nan], [inf, inf], [1e300] * 3, [0.0] * 3000],
    "sequence<string>": [[], ["arm"], ["pendulum", "arm"], ["arm", "arm"], ["x"] * 99],
    "sequence<uint64>": [[], [1], [1, 2], [2**64 - 1] * 99],
    "sequence<uint8>": [[], [255] * 9],
    "octet": [b"\xff"],
}


def is_sent(publisher: Publisher, message: Any) -> bool:
    """Publish a message; the middleware refuses bytes that are too many for their type."""
    try:
        publisher.publish(message)
    except RuntimeError:
        return False
    return True


def good(kind: Any) -> Any:
    """A message that a node answers, or an empty one."""
    if kind.__name__ == "JointState":
        return joint_state((0.01, 0.0, 0.01, 0.0), 10**9)
    return kind()


def odd(kind: Any) -> Iterator[Any]:
    """Messages that differ from a good one in one field."""
    for field, named in kind.get_fields_and_field_types().items():
        for value in _values(named, getattr(good(kind), field)):
            message = good(kind)
            try:
                setattr(message, field, value)
            except (AssertionError, OverflowError):  # no such message can be sent
                continue
            yield message


def _values(named: str, default: Any) -> list[Any]:
    if named in ODD:
        is_array = isinstance(default, array)
        return [array(default.typecode, each) if is_array else each for each in ODD[named]]
    if whole := re.fullmatch(r"(u?)int(\d+)", named):
        bits = int(whole[2]) - (not whole[1])
        return [0, 2**bits - 1, *([] if whole[1] else [-(2**bits)])]
    if element := re.fullmatch(r"sequence<(\w+)/(\w+)>", named):
        kind = getattr(import_module(f"{element[1]}.msg"), element[2])
        return [[], [kind()], *([each] for each in odd(kind)), [kind()] * 50]
    return list(odd(type(default))) if "/" in named else []
