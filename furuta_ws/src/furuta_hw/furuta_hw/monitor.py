"""A look into an emulated rig from outside: a Unix socket, one JSON object a line each way.

The line to the bridge is not involved, so what is said here of the drive is independent of it.
"""

from __future__ import annotations

import json
import socket
from collections.abc import Callable
from pathlib import Path
from threading import Thread
from typing import Any

# Longest wait for an answer [s].
TIMEOUT = 10.0


def serve(path: Path, answer: Callable[[dict[str, Any]], dict[str, Any]]) -> socket.socket:
    """Answer requests at ``path``, in a thread of its own, until the process ends."""
    path.unlink(missing_ok=True)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    listener.bind(str(path))
    listener.listen()

    def accept() -> None:
        while True:
            connection, _ = listener.accept()
            with connection, connection.makefile("rw") as lines:
                for line in lines:
                    try:
                        reply = answer(json.loads(line))
                    except (ValueError, TypeError, OSError) as error:
                        reply = {"error": str(error)}
                    lines.write(json.dumps(reply) + "\n")
                    lines.flush()

    Thread(target=accept, name="monitor", daemon=True).start()
    return listener


def ask(monitor: Path, do: str, **arguments: Any) -> dict[str, Any]:
    """Ask the emulated rig whose socket is ``monitor``; raises OSError if nobody answers."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.settimeout(TIMEOUT)
        connection.connect(str(monitor))
        with connection.makefile("rw") as lines:
            lines.write(json.dumps({"do": do, **arguments}) + "\n")
            lines.flush()
            reply: dict[str, Any] = json.loads(lines.readline())
            return reply
