"""Definitions and description hashes of message types."""

from __future__ import annotations

from contextlib import suppress
from functools import cache

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

JAZZY = get_typestore(Stores.ROS2_JAZZY)


@cache
def definition_of(type_name: str) -> str:
    """The definition of a type of ROS 2 Jazzy with all types that it contains."""
    return str(JAZZY.generate_msgdef(type_name, ros_version=2)[0])


@cache
def type_hash(type_name: str, definition: str) -> str:
    """The hash (REP 2011) of a type with this definition; empty if it cannot be parsed."""
    with suppress(Exception):  # a parser may raise anything
        return str(typestore_of(type_name, definition).hash_rihs01(type_name))
    return ""


def typestore_of(type_name: str, definition: str) -> Typestore:
    """The types in a definition."""
    types = get_typestore(Stores.EMPTY)
    types.register(get_types_from_msg(definition, type_name))
    return types
