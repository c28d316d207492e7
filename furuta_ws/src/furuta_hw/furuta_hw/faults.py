"""Faults that an emulated rig can be given, one by one or together."""

from __future__ import annotations

from collections import deque
from typing import Annotated, Any, NamedTuple

import numpy as np

from furuta_model.parameters import About, ParameterError, build, declared, values


class Faults(NamedTuple):
    """What is wrong with the line and the sensors."""

    lost: Annotated[float, About("part of the frames lost, both ways", "", 0, 1)] = 0.0
    repeated: Annotated[float, About("part that comes twice", "", 0, 1)] = 0.0
    corrupt: Annotated[float, About("part with one byte changed", "", 0, 1)] = 0.0
    late: Annotated[int, About("calls by which frames come late", "samples", 0, 10_000)] = 0
    silent: Annotated[bool, About("nothing passes, either way")] = False
    encoder_stuck: Annotated[bool, About("the arm's code no longer changes")] = False
    potentiometer_rail: Annotated[bool, About("the pendulum's code is the highest")] = False
    rig_fault: Annotated[bool, About("the rig reports a fault of its own")] = False


def with_faults(faults: Faults, given: dict[str, Any]) -> Faults:
    """``faults`` with some changed; raises ParameterError for a wrong name or value."""
    known = [each.name for each in declared(Faults)]
    for name in given:
        if name not in known:
            raise ParameterError(f"no fault {name}; faults are {', '.join(known)}")
    return build(Faults, values(faults) | given)


class Impairment:
    """One direction of a bad line."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self._rest = b""
        self._under_way: deque[bytes] = deque()

    def carry(self, data: bytes, faults: Faults) -> bytes:
        """What comes out at the other end; to be called once a sample, with nothing if need be."""
        if faults == Faults() and not self._rest and not self._under_way:
            return data
        *frames, self._rest = (self._rest + data).split(b"\0")
        out = b"".join(self._carried(frame + b"\0", faults) for frame in frames)
        self._under_way.append(out)
        due = max(0, len(self._under_way) - faults.late)
        out = b"".join(self._under_way.popleft() for _ in range(due))
        return b"" if faults.silent else out

    def _carried(self, frame: bytes, faults: Faults) -> bytes:
        lost, repeated, corrupt, place, value = self._random.random(5)
        if lost < faults.lost:
            return b""
        if corrupt < faults.corrupt:
            at = int(place * len(frame))
            changed = (frame[at] + 1 + int(value * 255)) % 256
            frame = frame[:at] + bytes((changed,)) + frame[at + 1 :]
        return frame * (2 if repeated < faults.repeated else 1)
