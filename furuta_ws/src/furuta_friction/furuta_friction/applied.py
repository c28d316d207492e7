"""The applied torque without the friction estimate that it contains.

Whether F̂ is part of the torque, and how many samples late, is up to others: a controller that does
not use it or a part of it, a rig that is not armed, a drive that reports late. A controller changes
its feedback less from sample to sample than F̂ changes with the sign of the friction. So the torque
contains that estimate, half of it or none, without which it changes least.
"""

from dataclasses import dataclass
from math import isnan
from typing import Final

import numpy as np

from furuta_model.block import zeros
from furuta_model.compiled import inlined

# Samples from which an estimate is too late to be found.
LATE: Final = 4
SENT: Final = LATE + 1
# Possibilities: the estimate with each lateness, half of it with each, and none.
NONE: Final = 2 * LATE
# Part of what is known of their changes that is forgotten in a sample; how many times less the mean
# square change must be for another possibility to be believed, and for none.
FORGOTTEN, BETTER, NONE_BETTER = 0.02, 4.0, 2.0


@dataclass
class AppliedMemory:
    """The torque before, the last estimates [V], mean square changes [V²], what is believed."""

    torque: float = 0.0
    sent: np.ndarray = zeros(SENT)
    changes: np.ndarray = zeros(NONE + 1)
    believed: int = 0


@inlined
def learn(memory: AppliedMemory, torque: float) -> None:
    """Learn from the ``torque`` [V] that has been applied since the sample before."""
    if isnan(torque):
        return
    change, best = torque - memory.torque, memory.believed
    memory.torque = torque
    for i in range(NONE + 1):
        left = change - _share(i) * (memory.sent[i % LATE] - memory.sent[i % LATE + 1])
        memory.changes[i] += FORGOTTEN * (left * left - memory.changes[i])
    present = least = memory.changes[best]
    for i in range(NONE):
        if memory.changes[i] < least:
            best, least = i, memory.changes[i]
    if NONE_BETTER * memory.changes[NONE] < present:
        memory.believed = NONE
    elif BETTER * least < present:
        memory.believed = best


@inlined
def _share(i: int) -> float:
    """The share of the estimate in the torque."""
    return 0.0 if i == NONE else 1.0 if i < LATE else 0.5


@inlined
def contained(memory: AppliedMemory) -> float:
    """What the applied torque contains of F̂ [V]."""
    return _share(memory.believed) * memory.sent[memory.believed % LATE]


@inlined
def too_late(memory: AppliedMemory) -> float:
    """What the torque lacks [V] because it contains an older estimate than the newest."""
    return _share(memory.believed) * (memory.sent[0] - memory.sent[memory.believed % LATE])


@inlined
def remember(memory: AppliedMemory, estimate: float) -> None:
    """Remember an ``estimate`` [V] as sent."""
    for i in range(SENT - 1):
        memory.sent[SENT - 1 - i] = memory.sent[SENT - 2 - i]
    memory.sent[0] = estimate


@inlined
def begin(memory: AppliedMemory, torque: float) -> None:
    """Begin with a ``torque`` [V], as if F̂ had been 0 V and were applied at once."""
    memory.torque = 0.0 if isnan(torque) else torque
    memory.believed = 0
    for i in range(SENT):
        memory.sent[i] = 0.0
    for i in range(NONE + 1):
        memory.changes[i] = 0.0
