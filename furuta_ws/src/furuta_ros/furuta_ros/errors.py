"""Errors that a user can correct, reported in one line without a traceback."""


class UserError(RuntimeError):
    """Something that the user asked for cannot be done; the message says why."""


def first_line(error: Exception) -> str:
    """The message of the error, without the source position that ROS adds at its end."""
    return str(error).strip().splitlines()[0].partition(", at /")[0]
