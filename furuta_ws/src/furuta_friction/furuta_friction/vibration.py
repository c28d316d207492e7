"""Reduces what causes a sustained vibration: swings from side to side, one soon after the other.

What the signal does slowly is removed by a high-pass filter. A swing is a change from beyond the
limit on one side to beyond it on the other. Friction that changes its sign is a single swing; a
vibration is many in a row. Each :data:`SUSTAINED` of them divide the part of the cause that may act
by :data:`REDUCTION`; it recovers slowly. This takes four multiplications a sample.
"""

from dataclasses import dataclass
from math import ceil, expm1, pi
from typing import NamedTuple

from furuta_model.compiled import inlined

# Frequency above which motion is a vibration [Hz]: beyond the bandwidth of the loop.
LOWEST_FREQUENCY = 15.0
# Swings in a row from which a vibration is sustained, and from which it is reduced again.
SUSTAINED = 4
REDUCTION = 4.0
RECOVERY_TIME = 2.0  # [s], in which a reduced part grows by a factor of e
SMALLEST_PART = 1 / 16


@dataclass
class VibrationMemory:
    """What the detector remembers.

    Attributes:
        slow: Slow part of the signal, in its unit.
        side: Side of the last swing, ±1; 0 before the first.
        swings: Swings in a row; once sustained, SUSTAINED and those since the last reduction.
        since: Samples since the last one.
        part: Part of the cause that may act, 1 without vibration.
    """

    slow: float = 0.0
    side: float = 0.0
    swings: int = 0
    since: int = 0
    part: float = 1.0


class Vibration(NamedTuple):
    """The sampled detector: limit in the signal's unit, share of the filter, longest swing.

    The longest swing is in samples; ``growth`` is that of the part in a sample.
    """

    limit: float
    share: float
    longest: int
    growth: float


def design(limit: float, dt: float, frequency: float = LOWEST_FREQUENCY) -> Vibration:
    """The detector for samples of ``dt`` [s] of vibrations beyond ``limit`` and ``frequency``."""
    return Vibration(
        limit=limit,
        share=-expm1(-2.0 * pi * frequency * dt),
        longest=ceil(0.5 / frequency / dt),
        growth=1.0 + dt / RECOVERY_TIME,
    )


@inlined
def allowed_share(memory: VibrationMemory, value: float, p: Vibration) -> float:
    """Include a ``value`` of the signal; the part of its cause that may act."""
    fast = value - memory.slow
    memory.slow += p.share * fast
    side = 1.0 if fast > p.limit else -1.0 if fast < -p.limit else 0.0
    swung = side * memory.side < 0.0
    memory.side = memory.side if side == 0.0 else side
    memory.since = 0 if swung else memory.since + 1
    in_a_row = 0 if memory.since > p.longest else memory.swings
    swings = in_a_row + 1 if swung else in_a_row
    memory.swings = SUSTAINED if swings == 2 * SUSTAINED else swings
    reduced = swung & (memory.swings == SUSTAINED)
    part = memory.part / REDUCTION if reduced else memory.part * p.growth
    memory.part = min(max(part, SMALLEST_PART), 1.0)
    return memory.part


@inlined
def is_sustained(memory: VibrationMemory) -> bool:
    """Whether the signal vibrates."""
    return memory.swings >= SUSTAINED
