"""What the page says of the timing, and of a rig."""

from typing import Any

import numpy as np

# The bridge publishes its diagnostics once a second; older ones say nothing about now [s].
OLDEST_STATUS = 4.0
UNKNOWN = "–"
# Latency [µs] from which a sample is late: that of the next sample.
LATE = 1000.0
# The rows of ``timing``: latency from measurement to command first.
TIMING_ROWS = 2


def rig_status(status: Any, age: float) -> dict[str, str]:
    """The newest diagnostics of the bridge of an age [s], for the page, or that there are none."""
    if status is None:
        return _told("not armed", "", "no diagnostics from the bridge")
    if age > OLDEST_STATUS:
        return _told("unknown", "unknown", f"the bridge has been silent for {age:.0f} s")
    values = {pair.key: pair.value for pair in status.values}
    title, kind = ("ARMED", "armed") if values["armed"] == "True" else ("not armed", "")
    reason = status.message.removeprefix(title).strip()  # it may say the same again
    return _told(title, kind, f"{reason}; {values['state']}, stops: {values['stops']}")


def _told(title: str, kind: str, text: str) -> dict[str, str]:
    return {"title": title, "kind": kind, "text": text}


def late_samples(timing: Any, status: Any) -> str:
    """Samples whose command came after the next sample, of all since the plant started.

    ``timing`` is the newest message on that topic, ``status`` that of the bridge to a rig, or None.
    """
    if status is not None:
        values = {pair.key: pair.value for pair in status.values}
        return f"{values.get('samples skipped', '0')} of {values.get('samples', '0')}"
    if timing is None:
        return UNKNOWN
    latency = np.array(timing.data).reshape(TIMING_ROWS, -1)[0]
    width = float(timing.layout.dim[1].label.split()[-2])
    return f"{int(latency[int(np.ceil(LATE / width)) :].sum())} of {int(latency.sum())}"
