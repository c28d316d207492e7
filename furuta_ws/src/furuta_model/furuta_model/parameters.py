"""Declares parameters: each one once, with default, unit, range and meaning.

A group of parameters is a ``NamedTuple`` whose fields are annotated with :class:`About`. ROS
parameter descriptors, command-line options, parameter files and the tables of the documentation
are generated from it. Compiled code takes the same tuple as an argument.

    class Motor(NamedTuple):
        gain: Annotated[float, About("torque per volt", "Nm/V", low=0.0)] = 1.0

A field can be a group itself. Its parameters then have dotted names (``motor.gain``), or plain
names if the field is annotated with :data:`INLINE`.
"""

import math
import re
import reprlib
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache, lru_cache
from typing import Annotated, Any, NamedTuple, TypeVar, cast, get_args, get_origin, get_type_hints

Group = TypeVar("Group", bound=NamedTuple)
Design = TypeVar("Design", bound=Callable[..., Any])
INLINE = "inline"
# Most names that a message suggests, and how a text begins that is meant as a number.
MOST_SUGGESTED = 3
_NUMBER = re.compile(r"\s*[-+]?[.,]?\d")
# Mark of a field of a design, ``Annotated[int, SELECTS]``: it selects what is computed.
SELECTS = "selects"
# Mark of a field whose zero means that a part is off; other values are numbers.
OFF_AT_ZERO = "off at zero"
LARGEST = sys.float_info.max
# Designs that are remembered: a study goes through them in order.
REMEMBERED = 256

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 80
_SHORT.maxlist = _SHORT.maxtuple = 8


class ParameterError(ValueError):
    """A parameter was given a value that is not allowed."""


@dataclass(frozen=True)
class About:
    """Meaning, unit and allowed values of a parameter.

    ``low`` and ``high`` are inclusive. ``read_only`` parameters can be set only at start. A
    ``shape`` has no effect while the others of its group are at their defaults. With ``own`` a
    name with a colon is allowed beside the choices: that of a part of one's own, which the group's
    ``check`` compiles (:mod:`furuta_model.own_functions`).
    """

    meaning: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()
    read_only: bool = False
    shape: bool = False
    own: bool = False

    @property
    def allowed(self) -> str:
        """The allowed values in words."""
        if self.choices:
            own = ", or one of own_parts" if self.own else ""
            return f"one of {', '.join(self.choices)}{own}"
        if self.low == -math.inf:
            return "any" if self.high == math.inf else f"at most {self.high:g}"
        if self.high == math.inf:
            return f"at least {self.low:g}"
        return f"{self.low:g} to {self.high:g}"


class Declared(NamedTuple):
    """A parameter with its full name, Python type (float, int, bool, str, list) and default."""

    name: str
    kind: type
    default: Any
    about: About

    def parsed(self, value: Any) -> Any:
        """Like :meth:`checked`, for a value from YAML or from the command line."""
        if self.kind is float:
            value = number_from_text(value)
        elif self.kind is list and isinstance(value, list):
            value = [number_from_text(element) for element in value]
        return self.checked(self.word_from_bool(value))

    def word_from_bool(self, value: Any) -> Any:
        """The word ``off`` or ``on`` that YAML 1.1 read as a boolean; other values unchanged."""
        if isinstance(value, bool) and self.kind is str:
            word = "on" if value else "off"
            return word if word in self.about.choices else value
        return value

    def checked(self, value: Any) -> Any:
        """Return ``value`` as the declared type, or raise :class:`ParameterError`.

        An empty list means the default, because ROS cannot know the type of an empty list.
        """
        if self.kind is list:
            if isinstance(value, (str, bytes)) or not isinstance(value, Sequence):
                raise ParameterError(
                    f"{self.name} must be a list of numbers, given {shortened(value)}"
                )
            return tuple(self._number(element) for element in value) or self.default
        if self.kind in (float, int):
            return self._number(value)
        if not isinstance(value, self.kind):
            raise ParameterError(
                f"{self.name} must be a {self.kind.__name__}, given {shortened(value)}"
            )
        is_own = self.about.own and names_part(str(value))
        if self.about.choices and value not in self.about.choices and not is_own:
            raise ParameterError(
                f"{self.name} must be {self.about.allowed}, given {shortened(value)}"
                + suggestion(str(value), self.about.choices)
            )
        return value

    def _number(self, value: Any) -> Any:
        about = self.about
        whole = self.kind is int
        if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)):
            kind = "an integer" if whole else "a number"
            raise ParameterError(
                f"{self.name} must be {kind}, given {shortened(value)}{number_hint(value)}"
            )
        if abs(value) > LARGEST or math.isnan(value):
            raise ParameterError(f"{self.name} must be finite, given {shortened(value)}")
        if not about.low <= value <= about.high:
            unit = f" {about.unit}" if about.unit else ""
            raise ParameterError(f"{self.name} must be {about.allowed}{unit}, given {value:g}")
        return value if whole else float(value)


def names_part(text: str) -> bool:
    """Whether a text may be the name of a part of one's own; numbers with a colon are a range."""
    return ":" in text and not text[0].isdigit()


def shortened(value: Any) -> str:
    """A value as a message shows it: what comes from outside can be millions of characters."""
    try:
        return _SHORT.repr(value)
    except ValueError:  # Python refuses to print thousands of digits
        return "an integer of too many digits"


def suggestion(name: str, known: Iterable[str]) -> str:
    """The end of a message that suggests the names most like an unknown one; empty if none is.

    Those that begin with it come before others. Capitals and the dashes of options do not count,
    and the last part of a dotted name may stand for it.
    """
    whole = {each.lstrip("-").lower(): each for each in known}
    found = {each.rpartition(".")[2]: full for each, full in whole.items()} | whole
    given = name.lstrip("-").rpartition(".")[2].lower()
    begun = [each for each in found if given and each.startswith(given)][:MOST_SUGGESTED]
    near = begun or get_close_matches(given, found, n=MOST_SUGGESTED)
    return f"; did you mean {', '.join(dict.fromkeys(found[each] for each in near))}?" * bool(near)


def number_hint(given: Any) -> str:
    """The end of a message on text that is no number: how to write it; empty if it is not near."""
    if not isinstance(given, str) or not _NUMBER.match(given):
        return ""
    if given.count(",") > 1:
        return "; separate numbers by blanks"
    if re.fullmatch(r"\s*[-+]?\d*,\d+\s*", given):
        return "; write a decimal point, not a comma"
    return "; give it without a unit"


def number_from_text(value: Any) -> Any:
    """Convert text such as ``1e-5`` to a number; any other value is returned as it is.

    YAML 1.1 reads a number with an exponent but without a decimal point as text.
    """
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value


@cache
def declared(group: type[NamedTuple], prefix: str = "") -> tuple[Declared, ...]:
    """All parameters of a group and of the groups inside it, in order."""
    return tuple(_declared(group, prefix))


@cache
def group_fields(group: type) -> tuple[tuple[str, Any, tuple[Any, ...]], ...]:
    """Name, type and marks of each field of a named tuple or a dataclass; () for a number.

    Marks are what the field is annotated with beside its type, such as About or SELECTS.
    """
    return tuple(
        (field, get_args(hint)[0], get_args(hint)[1:])
        if get_origin(hint) is Annotated
        else (field, hint, ())
        for field, hint in get_type_hints(group, include_extras=True).items()
    )


def fields_of(value: Any) -> tuple[tuple[str, Any, tuple[Any, ...]], ...]:
    """The same for the type of a value."""
    kind: Any = type(value)
    return group_fields(kind)


def _declared(group: type[NamedTuple], prefix: str) -> Iterator[Declared]:
    for field, kind, marks in group_fields(group):
        if _is_group(kind):
            yield from declared(kind, prefix if INLINE in marks else f"{prefix}{field}.")
        else:
            plain = list if get_origin(kind) is tuple else kind
            yield Declared(prefix + field, plain, group._field_defaults[field], marks[0])


def build(group: type[Group], given: Mapping[str, Any], prefix: str = "") -> Group:
    """Make a group from values by full name; missing values take their defaults.

    Names that the group does not have are ignored.

    Raises:
        ParameterError: A value is out of range or has the wrong type, or values contradict each
            other (the group's own ``check``).
    """
    declarations = {each.name: each for each in declared(group, prefix)}
    fields: dict[str, Any] = {}
    for field, kind, marks in group_fields(group):
        if _is_group(kind):
            inner = prefix if INLINE in marks else f"{prefix}{field}."
            fields[field] = build(kind, given, inner)
        else:
            each = declarations[prefix + field]
            fields[field] = each.checked(given.get(each.name, each.default))
    built: Group = cast(Any, group)(**fields)
    check = getattr(built, "check", None)
    if check:
        check()
    return built


def values(group: Any, prefix: str = "") -> dict[str, Any]:
    """All values of a group by full name: the inverse of :func:`build`."""
    result: dict[str, Any] = {}
    for field, kind, marks in fields_of(group):
        value = getattr(group, field)
        if _is_group(kind):
            result |= values(value, prefix if INLINE in marks else f"{prefix}{field}.")
        else:
            result[prefix + field] = list(value) if isinstance(value, tuple) else value
    return result


def validated(group: Group) -> Group:
    """The group, if each value is in its range and all fit together."""
    return build(type(group), values(group))


def designed_once(design: Design) -> Design:
    """Remember the last designs: parameters are checked by designing, and then applied."""
    return cast(Design, lru_cache(maxsize=REMEMBERED)(design))


def _is_group(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, "_fields")
