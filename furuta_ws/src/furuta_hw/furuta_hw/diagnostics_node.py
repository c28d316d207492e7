"""What the bridge says of itself on ``/diagnostics``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

if TYPE_CHECKING:
    from furuta_hw.bridge_node import HardwareBridgeNode


def diagnostics(bridge: HardwareBridgeNode) -> DiagnosticArray:
    """OK while it drives, WARN while it only reads, ERROR after a stop or without a line."""
    guard, connection = bridge.guard, bridge.connection
    values: dict[str, object] = {
        "state": bridge.state,
        "armed": guard.armed,
        "stops": guard.stops,
        "samples": bridge.samples,
    }
    if connection is not None:
        host = connection.host
        values |= {
            "frames lost": host.lost,
            "frames corrupt": host.corrupt,
            "frames repeated": host.repeated,
            "frames of other sessions": host.foreign,
            "frames the rig discarded": host.refused,
            "samples skipped": connection.skipped,
        }
    status = DiagnosticStatus(
        name=f"{bridge.get_name()}: rig",
        hardware_id=bridge.parameters.port,
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
    if guard.armed:
        status.level, status.message = DiagnosticStatus.OK, "driving"
    elif connection is None:
        status.level, status.message = DiagnosticStatus.ERROR, bridge.trouble or "no line"
    else:
        status.level = DiagnosticStatus.ERROR if guard.stops else DiagnosticStatus.WARN
        status.message = guard.reason
    message = DiagnosticArray(status=[status])
    message.header.stamp = bridge.get_clock().now().to_msg()
    return message
