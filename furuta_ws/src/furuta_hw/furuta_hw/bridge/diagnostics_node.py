"""The status that the bridge publishes on ``/diagnostics``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

if TYPE_CHECKING:
    from furuta_hw.bridge.bridge_node import HardwareBridgeNode


def diagnostics(bridge: HardwareBridgeNode) -> DiagnosticArray:
    """OK while it drives, WARN while it only reads, ERROR after a stop or without a line."""
    level, text = _summary(bridge)
    status = DiagnosticStatus(
        name=f"{bridge.get_name()}: rig",
        hardware_id=bridge.parameters.port,
        level=level,
        message=text,
        values=[KeyValue(key=key, value=str(value)) for key, value in _values(bridge).items()],
    )
    message = DiagnosticArray(status=[status])
    message.header.stamp = bridge.get_clock().now().to_msg()
    return message


def _summary(bridge: HardwareBridgeNode) -> tuple[bytes, str]:
    guard, connection = bridge.guard, bridge.connection
    if guard.armed:
        return DiagnosticStatus.OK, "driving"
    if connection is None or not connection.connected:
        failure = connection.failure if connection else bridge.failure
        return DiagnosticStatus.ERROR, failure or "no line"
    return DiagnosticStatus.ERROR if guard.stops else DiagnosticStatus.WARN, guard.reason


def _values(bridge: HardwareBridgeNode) -> dict[str, object]:
    values: dict[str, object] = {
        "state": bridge.state,
        "armed": bridge.guard.armed,
        "stops": bridge.guard.stops,
        "samples": bridge.samples,
    }
    connection = bridge.connection
    if connection is None:
        return values
    line = connection.statistics()
    return values | {
        "frames lost": line.lost,
        "frames corrupt": line.corrupt,
        "frames repeated": line.repeated,
        "frames of other sessions": line.other_sessions,
        "frames the rig discarded": line.discarded_by_rig,
        "samples skipped": connection.skipped_samples,
    }
