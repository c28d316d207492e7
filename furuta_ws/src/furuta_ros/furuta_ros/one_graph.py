"""One graph in a namespace and domain: a second one on this computer does not start.

Discovery cannot tell in time: it may take seconds until a node lists those of another process.
"""

import os
import socket

from rclpy.node import Node

from furuta_ros.discovery import is_private
from furuta_ros.errors import UserError

# Longest name of a socket in bytes (sun_path of unix(7), without its first byte).
LONGEST = 107


def claim_graph(node: Node) -> socket.socket:
    """Claim the graph of the node's namespace and domain until the socket is closed.

    The name of an abstract socket is free again as soon as its process ends, whatever ends it.

    Raises:
        UserError: A graph has claimed it.
    """
    domain, namespace = node.context.get_domain_id(), node.get_namespace()
    name = f"furuta graph {os.getpid() if is_private() else domain} {namespace}"
    claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claim.bind(b"\0" + name.encode()[:LONGEST])
    except OSError:
        claim.close()
        raise UserError(
            f"a graph already runs in namespace {namespace} of ROS domain {domain} on this "
            "computer: end it, or choose another namespace or ROS_DOMAIN_ID"
        ) from None
    return claim
