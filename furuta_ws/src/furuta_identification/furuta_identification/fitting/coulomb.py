"""Coulomb friction where a fit cannot find it: assumed, or given a second start."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.speeds import turns_one_way, with_speeds
from furuta_identification.shooting.optimisation import Optimum, best_of
from furuta_identification.shooting.parameter_values import ParameterValues
from furuta_identification.shooting.unknowns import BY_NAME
from furuta_model.state import PHI_DOT
from furuta_recordings.recording import Recording

# Assumed Coulomb friction as a part of the largest command, and its upper limit.
USUAL_PART = 0.03
LARGEST_PART = 0.25
# A fitted level below this part of its prior's standard deviation counts as none.
NEGLIGIBLE_PART = 0.3


class Setting(NamedTuple):
    """Unknowns to fit, their starting values, and those ``assumed`` (name: spread)."""

    names: list[str]
    start: ParameterValues
    assumed: dict[str, float]
    findings: list[str]


def assume_if_one_way(
    recordings: list[Recording], names: list[str], start: ParameterValues
) -> Setting:
    """Assume a Coulomb level where the arm never changes direction in any recording."""
    if not all(turns_one_way(recording) for recording in recordings):
        return Setting(names, start, {}, [])
    largest = max(recording.largest_command for recording in recordings)
    usual = max(USUAL_PART * largest, BY_NAME["coulomb"].spread)
    level = min(usual, LARGEST_PART * largest)
    finding = (
        "the arm turns in one direction only, where Coulomb friction has the same effect as a "
        f"smaller command: assumed {level:.3g} ± {level:.3g} V"
    )
    rest = [name for name in names if name not in ("coulomb", "asymmetry")]
    start = start.changed(["coulomb", "asymmetry"], [level, 0.0])
    return Setting(rest, start, {"coulomb": level}, [finding])


def with_second_start(optimum: Optimum) -> Optimum:
    """The better of a fit without Coulomb friction and one that starts with some.

    A fit without Coulomb friction is often a local optimum.
    """
    level = BY_NAME["coulomb"].spread
    if "coulomb" not in optimum.names or optimum.values["coulomb"] >= NEGLIGIBLE_PART * level:
        return optimum
    speeds = np.concatenate([with_speeds(r, 0.0).measured[:, PHI_DOT] for r in optimum.recordings])
    viscous = optimum.values["viscous"] - level / float(np.sqrt(np.mean(speeds**2)))
    start = optimum.values.changed(["coulomb", "viscous"], [level, max(viscous, 0.0)])
    return best_of((optimum, optimum.refitted(optimum.names, start)))
