"""Faults of an emulated rig, separately or combined."""

from collections import deque
from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from furuta_model.parameters import (
    About,
    Group,
    ParameterError,
    build,
    declared,
    suggestion,
    values,
)


class Faults(NamedTuple):
    """Faults of the line and of the sensors."""

    lost: Annotated[float, About("fraction of the frames lost, in both directions", "", 0, 1)] = 0.0
    repeated: Annotated[float, About("fraction of the frames sent twice", "", 0, 1)] = 0.0
    corrupt: Annotated[float, About("fraction of the frames with one byte changed", "", 0, 1)] = 0.0
    late: Annotated[int, About("delay of the frames", "samples", 0, 10_000)] = 0
    silent: Annotated[bool, About("no frame arrives, in either direction")] = False
    encoder_stuck: Annotated[bool, About("the arm's code does not change")] = False
    potentiometer_rail: Annotated[bool, About("the pendulum's code is the highest")] = False
    rig_fault: Annotated[bool, About("the rig reports a fault of its own")] = False


def with_faults(faults: Faults, given: dict[str, Any]) -> Faults:
    """Change some faults; raises :class:`ParameterError` for a wrong name or value."""
    return build_from_known(Faults, values(faults) | given, "fault")


def build_from_known(group: type[Group], given: Mapping[str, Any], kind: str) -> Group:
    """Make a group as :func:`build` does, but reject names that it does not have.

    ``kind`` is the word for one of its names, such as ``fault``.
    """
    known = [each.name for each in declared(group)]
    unknown = next((name for name in given if name not in known), None)
    if unknown is not None:
        raise ParameterError(
            f"no {kind} {unknown}; {kind}s are {', '.join(known)}{suggestion(unknown, known)}"
        )
    return build(group, given)


class FaultyLine:
    """One direction of a line with faults."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self._rest = b""
        self._in_transit: deque[bytes] = deque()

    def carry(self, data: bytes, faults: Faults) -> bytes:
        """Carry bytes to the other end; call once a sample, with no bytes if there are none."""
        if faults == Faults() and not self._rest and not self._in_transit:
            return data
        *frames, self._rest = (self._rest + data).split(b"\0")
        out = b"".join(self._with_faults(frame + b"\0", faults) for frame in frames)
        self._in_transit.append(out)
        due = max(0, len(self._in_transit) - faults.late)
        out = b"".join(self._in_transit.popleft() for _ in range(due))
        return b"" if faults.silent else out

    def _with_faults(self, frame: bytes, faults: Faults) -> bytes:
        lost, repeated, corrupt, place, value = self._random.random(5)
        if lost < faults.lost:
            return b""
        if corrupt < faults.corrupt:
            at = int(place * len(frame))
            changed = (frame[at] + 1 + int(value * 255)) % 256
            frame = frame[:at] + bytes((changed,)) + frame[at + 1 :]
        return frame * (2 if repeated < faults.repeated else 1)
