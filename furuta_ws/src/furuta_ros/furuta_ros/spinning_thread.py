"""Spins nodes in a thread of its own, so that several threads can wait for responses."""

from __future__ import annotations

import threading
from collections.abc import Iterable

from rclpy.node import Node
from rclpy.task import Future

from furuta_ros.spinning import executor_of, spin_until


class SpinningThread:
    """Spins ``nodes`` from now until :meth:`close`."""

    def __init__(self, nodes: Iterable[Node]) -> None:
        self._executor = executor_of(nodes)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Wait until ``future`` is done or the time is up, in any other thread."""
        done = threading.Event()
        future.add_done_callback(lambda _: done.set())
        done.wait(timeout_sec)

    def close(self, timeout: float) -> None:
        """Stop spinning, and wait up to ``timeout`` [s] for the thread."""
        self._ended.set()
        self._executor.wake()
        self._thread.join(timeout)

    def _run(self) -> None:
        spin_until(self._executor, self._ended.is_set)
