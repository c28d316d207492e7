"""Packages that only a part of the program needs: which one is missing, and what to install."""

from collections.abc import Iterator
from contextlib import contextmanager

# What pip calls a package that is imported by another name.
_DISTRIBUTIONS = {
    "flint": "python-flint",
    "serial": "pyserial",
    "yaml": "pyyaml",
}


@contextmanager
def needed_by(user: str) -> Iterator[None]:
    """Import what ``user`` needs; ModuleNotFoundError names what to install in one line."""
    try:
        yield
    except ModuleNotFoundError as error:
        name = (error.name or "").partition(".")[0]
        raise ModuleNotFoundError(missing(name, user), name=name) from None


def missing(name: str, user: str, source: str = "") -> str:
    """Says that ``user`` needs the module ``name``, and what installs it."""
    install = source or f"pip install {_DISTRIBUTIONS.get(name, name)}"
    return f"{user} needs {name}, which is not installed: {install}"
