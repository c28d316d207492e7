"""A graph has a namespace and a domain; a second one there does not start on this computer.

Discovery cannot tell in time: it may take seconds until a node lists those of another process.
"""

import os
import re
import socket

from furuta_model.parameters import ParameterError
from furuta_ros.errors import UserError
from furuta_ros.middleware import is_private

# Longest name of a socket in bytes (sun_path of unix(7), without its first byte).
LONGEST = 107


def claim(domain: int, namespace: str) -> socket.socket:
    """Claim the graph of a namespace and domain until the socket is closed.

    The name of an abstract socket is free again as soon as its process ends, whatever ends it.

    Raises:
        UserError: A graph has claimed it.
    """
    name = f"furuta graph {os.getpid() if is_private() else domain} {namespace}"
    claimed = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claimed.bind(b"\0" + name.encode()[:LONGEST])
    except OSError:
        claimed.close()
        raise UserError(
            f"a graph already runs in namespace {namespace} of ROS domain {domain} on this "
            f"computer: {view_command(namespace)} shows it; or end it, or choose another namespace "
            "or ROS_DOMAIN_ID"
        ) from None
    return claimed


def view_command(namespace: str) -> str:
    """The command that shows a graph that runs."""
    return f"furuta view --attach{namespace_option(namespace)}"


def namespace_option(namespace: str) -> str:
    """What a command for the graph of a namespace ends with."""
    name = namespace.strip("/")
    return f" --namespace {name}" if name else ""


def full_namespace(name: str) -> str:
    """The namespace with its leading slash, or empty; raises ParameterError if it is not valid."""
    bare = name.strip("/")
    if not bare:
        return ""
    if not re.fullmatch(r"[A-Za-z_]\w*(/[A-Za-z_]\w*)*", bare, re.ASCII):
        raise ParameterError(
            f"a namespace has letters, digits and _, and no digit first, given {name!r}"
        )
    return f"/{bare}"
