"""Memories as structures of C. Fields that no translated function uses are left out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from typing import Any, get_type_hints

import numpy as np

from furuta.export.functions import Translation
from furuta.export.text import comment, summary
from furuta.export.values import KINDS, usable


def structures(whole: Translation, *kinds: type) -> str:
    """The definitions of the structures of memories, each after those of the memories in it."""
    # The same memory may be in several places.
    return "\n\n".join(dict.fromkeys(text for kind in kinds for text in _definitions(whole, kind)))


def _definitions(whole: Translation, kind: type) -> Iterator[str]:
    lines = [comment(summary(kind)), "typedef struct {"]
    for name, each, value in _used(whole, kind):
        if isinstance(value, np.ndarray):
            size = "".join(f"[{n}]" for n in value.shape)
            lines.append(f"    {whole.precision.name} {name}{size};")
        elif _is_memory(each):
            yield from _definitions(whole, each)
            lines.append(f"    {whole.structure_name(each)} {name};")
        else:
            lines.append(f"    {whole.precision.type_of(KINDS[each])} {name};")
    yield "\n".join([*lines, f"}} {whole.structure_name(kind)};"])


def initialisation(whole: Translation, kind: type, path: str = "memory->") -> str:
    """Assignments of all initial numbers that are not zero; arrays begin with zeros."""
    text = ""
    for name, each, value in _used(whole, kind):
        if _is_memory(each):
            text += initialisation(whole, each, f"{path}{name}.")
        elif each is not np.ndarray and value:
            number = whole.constants.value(value, "", each)
            text += f"\n    {path}{name} = {number.text};"  # type: ignore[union-attr]
    return text


def _used(whole: Translation, kind: Any) -> Iterator[tuple[str, Any, Any]]:
    """Name, type and initial value of each field that is used."""
    hints, initial = get_type_hints(kind), kind()
    for field in fields(kind):
        if (kind, field.name) in whole.used_fields:
            yield usable(field.name), hints[field.name], getattr(initial, field.name)


def _is_memory(kind: type) -> bool:
    return kind is not np.ndarray and kind not in KINDS
