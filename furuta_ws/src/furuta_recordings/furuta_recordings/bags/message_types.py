"""Definitions and description hashes of message types."""

from contextlib import suppress
from functools import cache

from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import Typesdict
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from furuta_recordings.bags.limits import LARGEST_CHUNK, LARGEST_DESCRIPTION, DamagedError

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
    """The types in a definition.

    Raises:
        DamagedError: The definition is too long, or has an array that is.
    """
    if len(definition) > LARGEST_DESCRIPTION:
        raise DamagedError(f"{type_name} is defined by {len(definition)} characters")
    is_idl = definition.startswith("=" * 80 + "\nIDL: ")
    parsed = _types_from_idl(definition) if is_idl else get_types_from_msg(definition, type_name)
    for _, fields in parsed.values():
        for name, (kind, content) in fields:
            if kind == Nodetype.ARRAY and int(content[1]) > LARGEST_CHUNK:
                raise DamagedError(f"{name} in {type_name} has {content[1]} elements")
    types = get_typestore(Stores.EMPTY)
    types.register(parsed)
    return types


def _types_from_idl(definition: str) -> Typesdict:
    """Types from several files of IDL, each below a line with its name."""
    types: Typesdict = {}
    for file in definition.split("=" * 80 + "\n")[1:]:
        types |= get_types_from_idl(file.partition("\n")[2])
    return types
