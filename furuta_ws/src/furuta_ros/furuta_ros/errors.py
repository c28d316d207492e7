"""Errors that a user's situation causes, reported in one line without a traceback."""


class UserError(RuntimeError):
    """Something the user asked for cannot be done, with the reason in words."""
