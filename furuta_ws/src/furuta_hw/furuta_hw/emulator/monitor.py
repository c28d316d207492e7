"""Monitor of an emulated rig: a Unix socket with one JSON object per line in each direction.

It does not use the line to the bridge, so its report of the drive is independent of the bridge.
"""

import json
import socket
from collections.abc import Callable
from pathlib import Path
from threading import Thread
from typing import Any

# Longest wait for an answer [s].
TIMEOUT = 10.0


def serve(path: Path, answer: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
    """Answer requests at ``path`` on a thread until the process ends."""
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


def ask(monitor: Path, do: str, **arguments: Any) -> dict[str, Any]:
    """Send a request to the emulated rig with this socket; raises OSError without an answer."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
        connection.settimeout(TIMEOUT)
        connection.connect(str(monitor))
        with connection.makefile("rw") as lines:
            lines.write(json.dumps({"do": do, **arguments}) + "\n")
            lines.flush()
            reply: dict[str, Any] = json.loads(lines.readline())
            return reply
