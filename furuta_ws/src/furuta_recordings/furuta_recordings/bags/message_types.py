"""Definitions and description hashes of message types."""

from contextlib import suppress
from functools import cache

from rosbags.interfaces.typing import Typesdict
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
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
    """The types in a definition: of messages, or several files of IDL."""
    line = "=" * 80 + "\n"
    parsed: Typesdict = {}
    if definition.startswith(f"{line}IDL: "):
        for file in definition.split(line)[1:]:
            parsed |= get_types_from_idl(file.partition("\n")[2])
    else:
        parsed = get_types_from_msg(definition, type_name)
    types = get_typestore(Stores.EMPTY)
    types.register(parsed)
    return types
