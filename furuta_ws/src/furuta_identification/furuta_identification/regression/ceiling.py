"""The highest voltage that the drive reaches: a first value, from motions under larger commands."""

import numpy as np

from furuta_identification.regression.equations import ceiling_misfits
from furuta_identification.regression.speeds import with_speeds
from furuta_recordings.recording import Recording

# Ceilings that are tried, as parts of the largest command.
PARTS = np.linspace(0.3, 0.98, 35)
# Logarithm of the likelihood ratio from which a ceiling is there.
SURE = 10.0
# Part of the largest command within which all others are of the same level.
SAME_LEVEL = 0.05


def fitted_ceiling(recordings: list[Recording], lag: float, delay: float) -> float:
    """A first value of the ceiling [V], infinite where the arm's equation shows none."""
    ready = [with_speeds(r.with_delayed_command(delay), lag) for r in recordings]
    largest = max(r.largest_command for r in ready)
    misfits, samples = ceiling_misfits(ready, [*(PARTS * largest), np.inf])
    best = int(np.argmin(misfits))
    if samples * np.log(misfits[-1] / misfits[best]) < SURE:
        return float(np.inf)
    return float(PARTS[best] * largest)


def has_one_level(recordings: list[Recording]) -> bool:
    """Whether all commands are of one size, such as a step: then no ceiling can be found.

    A drive that reaches a part of the command only and a rig whose inertias and friction are larger
    in proportion give the same motion.
    """
    sizes = np.abs(np.concatenate([r.command for r in recordings]))
    largest = float(np.max(sizes))
    return bool(np.all((sizes == 0.0) | (sizes > (1.0 - SAME_LEVEL) * largest)))


def what_hides_a_ceiling(recordings: list[Recording]) -> list[str]:
    """A finding if no ceiling could be found in these recordings."""
    if not has_one_level(recordings):
        return []
    return [
        "the command has one level only, so a drive that reaches less cannot be noticed: all "
        "values in volts would be too large in proportion (state its limit with --ceiling)"
    ]
