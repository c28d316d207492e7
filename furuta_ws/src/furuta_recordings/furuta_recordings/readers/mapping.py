"""What the names in a recording mean."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from furuta_model.parameters import ParameterError

# What a command is called where the user names none.
COMMANDS = ("command", "effort_control", "u", "voltage")


class Mapping(NamedTuple):
    """What the user says of names: joints, topic of the states, topic or column of the command."""

    arm: str | None = None
    pendulum: str | None = None
    command: str | None = None
    states: str | None = None


def joints_of(path: Path, names: list[str], mapping: Mapping) -> tuple[tuple[str, str], list[str]]:
    """The names of arm and pendulum among those there are."""
    given = (mapping.arm, mapping.pendulum)
    for name in given:
        if name is not None and name not in names:
            raise ParameterError(f"{path}: no joint {name}; it has {', '.join(names) or 'none'}")
    if given[0] and given[1]:
        return (given[0], given[1]), []
    if "arm" in names and "pendulum" in names and given == (None, None):
        return ("arm", "pendulum"), []
    rest = [name for name in names if name not in given]
    if len(names) != 2:
        raise ParameterError(
            f"{path}: say which joint is which with --arm and --pendulum; it has "
            + (", ".join(names) or "none")
        )
    arm = given[0] or rest.pop(0)
    pendulum = given[1] or rest.pop(0)
    return (arm, pendulum), [f"{path.name}: {arm} taken for the arm, {pendulum} for the pendulum"]
