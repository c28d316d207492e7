"""The status that the bridge publishes on ``/diagnostics``."""

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

from furuta_hw.connection.rig_connection import RigConnection
from furuta_hw.guard import Guard


def rig_status(
    state: str, guard: Guard, connection: RigConnection | None, failure: str, samples: int
) -> DiagnosticStatus:
    """OK while it drives, WARN while it only reads, ERROR after a stop or without a line."""
    if guard.armed:
        level, text = DiagnosticStatus.OK, "driving"
    elif connection is not None and connection.connected:
        level = DiagnosticStatus.ERROR if guard.stops else DiagnosticStatus.WARN
        text = guard.reason
    else:
        reason = connection.failure if connection else failure
        level, text = DiagnosticStatus.ERROR, reason or "no line"
    values = {"state": state, "armed": guard.armed, "stops": guard.stops, "samples": samples}
    if connection is not None:
        line = connection.statistics()
        values |= {
            "frames lost": line.lost,
            "frames corrupt": line.corrupt,
            "frames repeated": line.repeated,
            "frames of other sessions": line.other_sessions,
            "frames the rig discarded": line.discarded_by_rig,
            "samples skipped": connection.skipped_samples,
        }
    pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
    return DiagnosticStatus(level=level, message=text, values=pairs)
