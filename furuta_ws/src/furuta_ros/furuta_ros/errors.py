"""Errors that a user can correct, reported in one line without a traceback."""

from traceback import extract_tb


class UserError(RuntimeError):
    """Something that the user asked for cannot be done; the message says why."""


def first_line(error: Exception) -> str:
    """The message of the error, without the source position that ROS adds at its end."""
    return str(error).strip().splitlines()[0].partition(", at /")[0]


def described(error: BaseException) -> str:
    """An exception that nobody expects, in one line with its place."""
    *_, (file, line, name, _) = extract_tb(error.__traceback__)
    return f"{name} failed ({file}, line {line}): {type(error).__name__}: {error}"
