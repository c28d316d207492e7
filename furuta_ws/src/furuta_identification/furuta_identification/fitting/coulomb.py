"""Coulomb friction of an arm that turns in one direction only: no fit can find it."""

from typing import NamedTuple

from furuta_identification.regression.speeds import turns_one_way
from furuta_identification.shooting.unknowns import BY_NAME, ParameterValues
from furuta_recordings.recording import Recording

# Assumed Coulomb friction as a part of the largest command, and its upper limit.
USUAL_PART = 0.03
LARGEST_PART = 0.25


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
