"""The parts of the user's own that a process accepts, by name.

Whoever starts a process names them, as ``module:function`` or ``file.py:function``
(:func:`accept_parts`). A parameter can only choose among these names, wherever it comes from: no
other code is imported. A part that a program gives as an object has such a name too.
"""

import sys
from collections.abc import Iterable
from importlib import import_module
from importlib.machinery import SourceFileLoader
from itertools import chain, count
from operator import attrgetter
from pathlib import Path
from types import ModuleType
from typing import Any

from furuta_model.parameters import ParameterError, shortened

# The parameter and the option that name the parts that a process accepts.
OWN_PARTS = "own_parts"
# The parts that this process accepts, by name, and the names of those that it has imported.
_accepted: dict[str, Any] = {}
_imported_names: list[str] = []


def parts_in(given: Any) -> list[str]:
    """The names in a parameter: text with commas, or a list of text."""
    names = given.split(",") if isinstance(given, str) else given
    if not isinstance(names, (list, tuple)) or not all(isinstance(name, str) for name in names):
        raise ParameterError(f"{OWN_PARTS} must be names, separated by commas; given {given!r}")
    return [name.strip() for name in names if name.strip()]


def accept_parts(names: Iterable[str]) -> None:
    """Import the parts with these names, and accept the names in parameters from now on.

    The names must come from whoever starts the process. Modules are found on Python's path, to
    which the working directory does not belong.

    Raises:
        ParameterError: A part cannot be imported, or is no part.
    """
    for name in names:
        if name not in _accepted:
            _accepted[name] = _imported(name)
            _imported_names.append(name)


def accepted_parts() -> list[str]:
    """The names that :func:`accept_parts` was given; another process can accept them too."""
    return list(_imported_names)


def is_accepted(name: str) -> bool:
    """Whether this process accepts the name."""
    return name in _accepted


def part_name(part: Any) -> str:
    """The name of a part that is given as an object; it is valid in this process."""
    name = getattr(part, "name", None) or f"{part.__module__}:{part.__qualname__}"
    name = name if ":" in name else f"own:{name}"
    names = chain([name], (f"{name} {number}" for number in count(2)))
    return next(unique for unique in names if _accepted.setdefault(unique, part) == part)


def accepted_part(name: str) -> Any:
    """The accepted part with this name.

    Raises:
        ParameterError: This process does not accept the name; nothing has been imported.
    """
    if name not in _accepted:
        raise ParameterError(
            f"{shortened(name)} is not accepted; name it when the process starts: furuta VERB "
            "--own-parts NAME, or --ros-args -p own_parts:=NAME for a node. Accepted: "
            + (", ".join(_accepted) or "none")
        )
    return _accepted[name]


def _imported(name: str) -> Any:
    """The object ``module:name`` or ``file.py:name``."""
    module, colon, attribute = name.rpartition(":")
    try:
        if not (colon and module and attribute):
            raise ValueError("expected module:function or file.py:function")
        found = _from_file(Path(module)) if module.endswith(".py") else import_module(module)
        return attrgetter(attribute)(found)
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}".splitlines()[0]
        if isinstance(error, ModuleNotFoundError):
            reason += "; for a file of your own write file.py:function"
        raise ParameterError(f"cannot load the part {shortened(name)}: {reason}") from None


def _from_file(path: Path) -> ModuleType:
    """The module in a file; its name is the full path, which no other module has."""
    name = str(path.resolve())
    if name not in sys.modules:
        loader = SourceFileLoader(name, name)
        module = ModuleType(name)
        module.__file__ = name
        sys.modules[name] = module  # where the hints of its functions are looked up
        try:
            loader.exec_module(module)
        except BaseException:
            del sys.modules[name]
            raise
    return sys.modules[name]
