"""Checks the arguments of a function against its annotations, in one line for who gave them.

Numbers must be finite, because compiled code takes NaN for a number. Of a named tuple every field
is checked. Its arrays, and numbers that are no declared parameters, may be NaN or infinite, as in
results. The annotation of an array may have its shape, such as ``Annotated[np.ndarray, "n", 4]``.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, lru_cache, wraps
from inspect import Parameter, signature
from itertools import zip_longest
from numbers import Integral, Real
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, NamedTuple, TypeVar, Union, cast, get_args, get_origin

import numpy as np

from furuta_model.parameters import LARGEST, ParameterError, group_fields, shortened

Function = TypeVar("Function", bound=Callable[..., Any])


class _Kind(NamedTuple):
    """What an annotation allows, in words and as a condition, and what the function is given."""

    words: str
    holds: Callable[[Any], bool]
    convert: Callable[[Any], Any] = lambda value: value


def checked(function: Function) -> Function:
    """The function, which raises ParameterError for an argument that its annotation excludes."""
    about = signature(function)

    @wraps(function)
    def call(*given: Any, **options: Any) -> Any:
        try:
            bound = about.bind(*given, **options)
        except TypeError as error:
            raise TypeError(f"{function.__name__}() {error}") from None
        for name, value in bound.arguments.items():
            parameter = about.parameters[name]
            hint = _evaluated(parameter.annotation, function)
            if parameter.kind is Parameter.VAR_KEYWORD:
                bound.arguments[name] = {key: check(key, value[key], hint) for key in value}
            else:
                bound.arguments[name] = check(name, value, hint)
        try:
            return function(*bound.args, **bound.kwargs)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            reason = f"the numbers given are too large or too small to compute with: {error}"
            raise ParameterError(reason) from error

    return cast(Function, call)


def check(name: str, value: Any, hint: Any) -> Any:
    """The value as a plain number, array or list; ParameterError if ``hint`` does not allow it."""
    kinds = _kinds(hint)
    for each, kind in kinds.items():
        if kind.holds(value):
            return _with_content(name, kind.convert(value), each)
    allowed = " or ".join(kind.words for kind in kinds.values())
    given = " ".join(shortened(value).split())
    raise ParameterError(f"{name} must be {allowed}, given {given}")


def _with_content(name: str, value: Any, hint: Any) -> Any:
    """The value with its fields, names or elements checked."""
    if hasattr(hint, "_fields"):
        try:
            return _known_group(name, value, hint)
        except TypeError:  # arrays have no hash
            return _group(name, value, hint)
    origin = get_origin(hint)
    if origin is Mapping:
        key, *_ = get_args(hint) or (str,)
        for each in value:
            check(f"a name in {name}", each, key)
    elif origin in (Iterable, Sequence):
        return [check(f"{name}[{k}]", each, *get_args(hint)) for k, each in enumerate(value)]
    return value


def _group(name: str, group: Any, hint: Any) -> Any:
    """The named tuple with its fields checked; NaN may be in arrays and in what is not declared."""
    _check_shapes(name, group, hint)
    checked_fields = {}
    for field, kind, marks in group_fields(hint):
        value = getattr(group, field)
        may_be_nan = kind is np.ndarray or (kind is float and not marks)
        if not (may_be_nan and isinstance(value, kind)):
            checked_fields[field] = check(f"{name}.{field}", value, kind)
    return group._replace(**checked_fields)


_known_group = lru_cache(_group)  # a loop has hundreds of fields


def _check_shapes(name: str, group: Any, hint: Any) -> None:
    """Check the arrays whose annotation has a shape, in which a letter is one and the same size."""
    sizes: dict[Any, int] = {}
    for field, kind, marks in group_fields(hint):
        if kind is np.ndarray and marks:
            given = np.shape(getattr(group, field))
            expected = tuple(
                sizes.setdefault(size, actual) if isinstance(size, str) else size
                for size, actual in zip_longest(marks, given[: len(marks)])
            )
            if given != expected:
                raise ParameterError(f"{name}.{field} must have shape {expected}, given {given}")


def _evaluated(annotation: Any, function: Any) -> Any:
    """The annotation, which is text in a module with ``from __future__ import annotations``."""
    if annotation is Parameter.empty:
        return Any
    return eval(annotation, function.__globals__) if isinstance(annotation, str) else annotation


@cache
def _kinds(hint: Any) -> dict[Any, _Kind]:
    """What an annotation allows, each of several with its own; as Any, what has no condition."""
    hints = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
    return {each: _kind(get_origin(each) or each) for each in hints}


def _kind(origin: Any) -> _Kind:
    if origin in _KINDS or not isinstance(origin, type):
        return _KINDS.get(origin, _ANYTHING)
    return _Kind(origin.__name__, lambda value: isinstance(value, origin))


def _is_number(value: Any) -> bool:
    is_real = isinstance(value, Real) and not isinstance(value, bool)
    return is_real and bool(abs(value) <= LARGEST)


def _is_array(value: Any) -> bool:
    """Whether it is an array of finite numbers, or a list that numpy makes one of."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        return False
    return array.ndim > 0 and array.dtype.kind in "iuf" and bool(np.all(np.isfinite(array)))


def _is_list(value: Any) -> bool:
    return isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)


_ANYTHING = _Kind("anything", lambda value: True)
_LIST = _Kind("a list", _is_list, list)
_KINDS: dict[Any, _Kind] = {
    Any: _ANYTHING,
    float: _Kind("a finite number", _is_number, float),
    int: _Kind("an integer", lambda v: isinstance(v, Integral) and not isinstance(v, bool), int),
    bool: _Kind("True or False", lambda value: isinstance(value, bool | np.bool_), bool),
    str: _Kind("text", lambda value: isinstance(value, str)),
    Path: _Kind("a path", lambda value: isinstance(value, str | Path), Path),
    NoneType: _Kind("None", lambda value: value is None),
    np.ndarray: _Kind("an array of finite numbers", _is_array, np.asarray),
    Callable: _Kind("a function", callable),
    Mapping: _Kind("a mapping", lambda value: isinstance(value, Mapping)),
    Iterable: _LIST,
    Sequence: _LIST,
}
