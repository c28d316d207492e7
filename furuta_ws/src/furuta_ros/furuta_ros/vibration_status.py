"""Tells users that a vibration has reduced what a node does: in its log and on ``/diagnostics``."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from furuta_ros.node import FurutaNode
from furuta_ros.topics import DIAGNOSTICS

# Time between two reports while something is reduced [s].
REPORT_PERIOD = 1.0


class VibrationStatus:
    """Reports for a ``node`` that ``what`` is reduced, until the ``part`` that acts is 1 again."""

    def __init__(self, node: FurutaNode, what: str, part: Callable[[], float]) -> None:
        self._node, self._what, self._part = node, what, part
        self._reduced = False
        self._publisher = node.create_publisher(DIAGNOSTICS.type, DIAGNOSTICS.name, 10)
        node.steady_timer(REPORT_PERIOD, self._report_again)

    def report(self) -> None:
        """Report at once that a vibration has reduced it."""
        self._reduced = True
        reason = self._reason()
        self._node.warn("vibration", reason)
        self._publish(DiagnosticStatus.WARN, reason)

    def _reason(self) -> str:
        return (
            f"a sustained vibration above 15 Hz has reduced {self._what} to {self._part():.0%}; it "
            "recovers by itself. Motor and arm may be coupled elastically, or a delay is too long"
        )

    def _report_again(self) -> None:
        if not self._reduced:
            return
        self._reduced = self._part() < 1.0
        if self._reduced:
            self._publish(DiagnosticStatus.WARN, self._reason())
        else:
            self._publish(DiagnosticStatus.OK, f"{self._what} acts fully again")

    def _publish(self, level: bytes, text: str) -> None:
        name = f"{self._node.get_name()}: vibration"
        message = DiagnosticArray(status=[DiagnosticStatus(level=level, name=name, message=text)])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)
