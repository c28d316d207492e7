"""Tells users on ``/diagnostics`` that a node does less than they asked for, and why."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from furuta_ros.node import FurutaNode
from furuta_ros.topics import DIAGNOSTICS

# Time between two reports while something is reduced [s].
REPORT_PERIOD = 1.0
FULL = "acts fully again"
# How the names of these statuses end, after that of the node.
NAME_END = ": reduction"


class ReductionStatus:
    """Publishes for a ``node`` why something is reduced, until ``reason()`` is empty again."""

    def __init__(self, node: FurutaNode, reason: Callable[[], str]) -> None:
        self._node, self._reason = node, reason
        self._reduced = False
        self._publisher = node.create_publisher(DIAGNOSTICS.message, DIAGNOSTICS.name, 10)
        node.steady_timer(REPORT_PERIOD, self._report_again)

    def report(self) -> None:
        """Log and publish at once that it has been reduced."""
        self._reduced = True
        reason = self._reason()
        self._node.warn("reduction", reason)
        self._publish(DiagnosticStatus.WARN, reason)

    def _report_again(self) -> None:
        if not self._reduced:
            return
        reason = self._reason()
        self._reduced = bool(reason)
        level = DiagnosticStatus.WARN if reason else DiagnosticStatus.OK
        self._publish(level, reason or FULL)

    def _publish(self, level: bytes, text: str) -> None:
        name = f"{self._node.get_name()}{NAME_END}"
        message = DiagnosticArray(status=[DiagnosticStatus(level=level, name=name, message=text)])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)


def vibration_reason(what: str, part: float) -> str:
    """Why only a ``part`` of ``what`` acts; empty if all of it does."""
    if part >= 1.0:
        return ""
    return (
        f"a sustained vibration above 15 Hz has reduced {what} to {part:.0%}; it recovers by "
        "itself. Motor and arm may be coupled elastically, or a delay is too long"
    )
