"""The applied torque without the friction estimate that it contains.

Whether F̂ is part of the torque, and how many samples late, is up to others: a controller that does
not use it, a rig that is not armed, a drive that reports late. A controller changes its feedback
less from sample to sample than F̂ changes with the sign of the friction. So the torque contains that
estimate, or none, without which it changes least.
"""

from dataclasses import dataclass
from math import isnan
from typing import Final

import numpy as np

from furuta_model.block import zeros
from furuta_model.compiled import inlined

# Estimates that are remembered: a torque can contain any but the last of them.
SENT: Final = 5
# The place of "none" among the possibilities; those before are the samples by which it is late.
NONE: Final = SENT - 1
# Part of what is known of their changes that is forgotten in a sample; how many times less the mean
# square change must be for another possibility to be believed.
FORGOTTEN, BETTER = 0.02, 4.0


@dataclass
class AppliedMemory:
    """The torque before, the last estimates [V], mean square changes [V²], what is believed."""

    torque: float = 0.0
    sent: np.ndarray = zeros(SENT)
    changes: np.ndarray = zeros(SENT)
    late: int = 0


@inlined
def learn(memory: AppliedMemory, torque: float) -> None:
    """Learn from the ``torque`` [V] that has been applied since the sample before."""
    if isnan(torque):
        return
    best = memory.late
    for i in range(SENT):
        change = torque - memory.torque
        if i < NONE:
            change -= memory.sent[i] - memory.sent[i + 1]
        memory.changes[i] += FORGOTTEN * (change * change - memory.changes[i])
        if memory.changes[i] < memory.changes[best]:
            best = i
    if BETTER * memory.changes[best] < memory.changes[memory.late]:
        memory.late = best
    memory.torque = torque


@inlined
def is_applied(memory: AppliedMemory) -> bool:
    """Whether the torque contains an estimate."""
    return memory.late < NONE


@inlined
def contained(memory: AppliedMemory) -> float:
    """F̂ [V] in the applied torque."""
    return memory.sent[memory.late] if is_applied(memory) else 0.0


@inlined
def too_late(memory: AppliedMemory) -> float:
    """What the torque lacks [V] of the newest estimate if it contains an older one."""
    return memory.sent[0] - memory.sent[memory.late] if is_applied(memory) else 0.0


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
    memory.late = 0
    for i in range(SENT):
        memory.sent[i] = memory.changes[i] = 0.0
