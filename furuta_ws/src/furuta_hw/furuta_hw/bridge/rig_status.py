"""The status that the bridge publishes on ``/diagnostics``."""

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from furuta_hw.connection.rig_connection import RigConnection
from furuta_hw.guard import Guard


def rig_status(
    state: str, guard: Guard, connection: RigConnection | None, failure: str, samples: int
) -> DiagnosticStatus:
    """OK while it drives, WARN while it only reads, ERROR after a stop or without a line."""
    level, text = _summary(guard, connection, failure)
    values = {"state": state, "armed": guard.armed, "stops": guard.stops, "samples": samples}
    if connection is not None:
        values |= _line_values(connection)
    return DiagnosticStatus(
        level=level,
        message=text,
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )


def _summary(guard: Guard, connection: RigConnection | None, failure: str) -> tuple[bytes, str]:
    if guard.armed:
        return DiagnosticStatus.OK, "driving"
    if connection is None or not connection.connected:
        reason = connection.failure if connection else failure
        return DiagnosticStatus.ERROR, reason or "no line"
    return DiagnosticStatus.ERROR if guard.stops else DiagnosticStatus.WARN, guard.reason


def _line_values(connection: RigConnection) -> dict[str, int]:
    line = connection.statistics()
    return {
        "frames lost": line.lost,
        "frames corrupt": line.corrupt,
        "frames repeated": line.repeated,
        "frames of other sessions": line.other_sessions,
        "frames the rig discarded": line.discarded_by_rig,
        "samples skipped": connection.skipped_samples,
    }
