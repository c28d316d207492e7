"""The recommended compensation, ``compensation=recommended``: settings of three nodes for a rig.

It is the combined compensation, with delay and lag of the drive as they are described, by a rig
file or by the parameters of the plant. All three nodes are told.
"""

from typing import Any

from furuta_model.late_drive import LateDrive
from furuta_model.parameters import values
from furuta_sim.simulation.closed_loop import Loop

RECOMMENDED = "recommended"
# The compensation that it is.
RECOMMENDED_WORD = "combined"
COMPENSATION = "friction_observer.compensation"
# What it sets beside the compensation.
RECOMMENDED_NAMES = tuple(
    f"{node}.drive.{name}"
    for node in ("estimator", "friction_observer", "controller")
    for name in LateDrive._fields
)


def is_compensation(name: str) -> bool:
    """Whether this is a name of the compensation."""
    return name in ("compensation", COMPENSATION)


def is_recommended(name: str, value: Any) -> bool:
    """Whether a setting asks for the recommended compensation."""
    return value == RECOMMENDED and is_compensation(name)


def recommended_values(loop: Loop, held: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Values by full name for the rig that the ``loop`` describes, without those of ``held``."""
    drive = values(known_drive(loop), "drive.")
    told = {name: drive[name.partition(".")[2]] for name in RECOMMENDED_NAMES}
    return {
        COMPENSATION: RECOMMENDED_WORD,
        **{name: value for name, value in told.items() if name not in held},
    }


def known_drive(loop: Loop) -> LateDrive:
    """Delay and lag of the drive that a loop describes."""
    drive = loop.plant.drive
    return LateDrive(drive.delay, drive.lag)
