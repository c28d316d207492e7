"""Which names in a recording are the arm, the pendulum and the command."""

from pathlib import Path
from typing import NamedTuple

from furuta_model.parameters import ParameterError
from furuta_ros.topics import JOINTS

# Usual names of the command, looked for if the user names none.
COMMANDS = ("command", "effort_control", "u", "voltage")
# Name of the command if the motor was not driven.
NO_COMMAND = "none"


class Mapping(NamedTuple):
    """Names given by the user: joints, command (topic or column), states (topic), time (column).

    ``command`` is "none" if the motor was not driven. A table without a header has ``columns``,
    separated by commas, one without times has a ``rate`` [Hz].
    """

    arm: str | None = None
    pendulum: str | None = None
    command: str | None = None
    states: str | None = None
    time: str | None = None
    columns: str | None = None
    rate: float | None = None


def split_names(columns: str | None) -> list[str]:
    """Names of columns that are separated by commas."""
    return [name.strip() for name in columns.split(",")] if columns else []


def only_one(path: Path, matching: list[str], what: str, option: str) -> str:
    """The only one of several that may be ``what``; raises ParameterError for several."""
    if len(matching) > 1:
        raise ParameterError(
            f"{path}: any of {', '.join(matching)} may be the {what}; name it with {option}"
        )
    return matching[0]


def joints_of(path: Path, names: list[str], mapping: Mapping) -> tuple[tuple[str, str], str]:
    """Which of the joints ``names`` are arm and pendulum; and how that was interpreted."""
    given = (mapping.arm, mapping.pendulum)
    for name in given:
        if name is not None and name not in names:
            raise ParameterError(f"{path}: no joint {name}; it has {', '.join(names) or 'none'}")
    if given[0] and given[1]:
        return (given[0], given[1]), ""
    if set(JOINTS) <= set(names) and given == (None, None):
        return JOINTS, ""
    if len(names) != 2:
        raise ParameterError(
            f"{path}: name the joints with --arm and --pendulum; it has "
            + (", ".join(names) or "none")
        )
    rest = [name for name in names if name not in given]
    arm = given[0] or rest.pop(0)
    pendulum = given[1] or rest.pop(0)
    return (arm, pendulum), f"assumed {arm} to be the arm, {pendulum} the pendulum"
