"""Finds the columns of the joints in a table by the words of their names."""

from collections.abc import Iterable

from furuta_recordings.readers.column_names import column

# Last words of the names of an angle and of a speed; the words between joint and speed may be any
# of FILLERS, as in `arm angle dot`.
ANGLE_WORDS = ("position", "angle", "pos", "encoder")
SPEED_WORDS = ("velocity", "speed", "dot", "vel", "rate")
FILLERS = ("angle", "angular", "position", "pos")


def joint_names(columns: Iterable[str]) -> list[str]:
    """Names of joints in columns such as /joint_states/NAME/position, NAME_angle, `Name angle`."""
    names: list[str] = []
    for name in columns:
        words = column(name).words
        if len(words) > 1 and words[-1] in ANGLE_WORDS:
            joint = _joint_in(name)
            if joint not in names:
                names.append(joint)
    return names


def _joint_in(name: str) -> str:
    """The joint in the name of an angle: all but the last word of the path's last part.

    A part that is only the word for the angle belongs to the joint that is named before it.
    """
    parts = [part for part in name.replace(".", "/").split("/") if part]
    words = column(parts[-1]).words
    return parts[-2] if len(words) == 1 else "_".join(words[:-1])


def words_of(joint: str) -> tuple[str, ...]:
    """The words of a joint's name."""
    return column(joint).words


def joint_column(columns: Iterable[str], joint: str, endings: tuple[str, ...]) -> str | None:
    """The first column named after the joint and one of the endings."""
    wanted = words_of(joint)
    for name in columns:
        words = column(name).words
        if len(words) < 2 or words[-1] not in endings:
            continue
        rest = words[:-1]
        while rest and rest[-1] in FILLERS and rest[-len(wanted) :] != wanted:
            rest = rest[:-1]
        if rest[-len(wanted) :] == wanted:
            return name
    return None
