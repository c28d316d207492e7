"""Makes groups from a list of parts, such as compensators: parameters, memories and designs.

A part is a named tuple with ``name``, ``parameters`` (a named tuple type), ``inline``, ``memory``
(a dataclass) and ``design`` (a function of all parameters of the node); each may be None. A field
of a group has the name of its part. So a part stands in a file of its own, and no group names it.
"""

from collections import namedtuple
from collections.abc import Callable, Iterable, Sequence
from dataclasses import field, make_dataclass
from functools import lru_cache
from importlib import import_module
from typing import Annotated, Any, TypeVar, cast

from furuta_model.compiled import inlined
from furuta_model.parameters import INLINE

Design = TypeVar("Design", bound=Callable[..., Any])
# Designs that are remembered: a study goes through them in order.
REMEMBERED = 256


def designed_once(design: Design) -> Design:
    """Remember the last designs: parameters are checked by designing, and then applied."""
    return cast(Design, lru_cache(maxsize=REMEMBERED)(design))


def parts_in(package: str, modules: Iterable[str]) -> tuple[Any, ...]:
    """The parts in these modules of a package; each module has its own as ``PART``."""
    return tuple(import_module(f"{package}.{name}").PART for name in modules)


def groups_of(parts: Sequence[Any], module: str, kind: str) -> tuple[Any, Any, Any]:
    """The types KINDParameters, KINDMemories and KINDDesigns of a registry in ``module``.

    With ``inline`` the names of a part's parameters do not begin with that of the part.
    """
    given = [part for part in parts if part.parameters is not None]
    parameters = {p.name: Annotated[p.parameters, INLINE if p.inline else ""] for p in given}
    memories: list[Any] = [
        (p.name, p.memory, field(default_factory=p.memory)) for p in parts if p.memory is not None
    ]
    # numpy 1 ends the process on a structured type without fields.
    memory = make_dataclass(f"{kind}Memories", memories or [("none", bool, False)])
    memory.__doc__ = "What each part remembers, by its name."
    memory.__module__ = module
    return (
        _named_tuple(f"{kind}Parameters", module, parameters, [p.parameters() for p in given]),
        memory,
        _named_tuple(f"{kind}Designs", module, {p.name: Any for p in parts if _is_designed(p)}),
    )


def _named_tuple(name: str, module: str, fields: dict[str, Any], defaults: Any = ()) -> Any:
    made: Any = namedtuple(name, fields, defaults=defaults, module=module)  # type: ignore[misc]
    made.__annotations__ = fields
    made.__doc__ = "A field for each part, by its name."
    return made


def _is_designed(part: Any) -> bool:
    return part.design is not None or part.parameters is not None


def design_parts(parts: Iterable[Any], p: Any) -> tuple[Any, ...]:
    """The designs, for all parameters ``p``: by default the part's parameters."""
    return tuple(
        part.design(p) if part.design else getattr(p.parts, part.name)
        for part in parts
        if _is_designed(part)
    )


def in_turn(functions: Iterable[Any]) -> Any:
    """A compiled function of a memory that calls these functions one after the other."""
    first, *others = functions
    if not others:
        return first
    rest = in_turn(others)

    def call(memory: Any) -> None:
        first(memory)
        rest(memory)

    return inlined(call, cached=False)
