"""What the page says of the timing, and of a rig."""

import re
from math import ceil
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus

# The bridge publishes its diagnostics once a second; older ones say nothing about now [s].
OLDEST_STATUS = 4.0
UNKNOWN = "–"
# Latency [µs] from which a sample is late: that of the next sample.
LATE = 1000.0


def rig_status(status: Any, age: float) -> dict[str, str]:
    """The newest diagnostics of the bridge of an age [s], for the page, or that there are none."""
    if status is None:
        return _told("not armed", "", "no diagnostics from the bridge")
    if age > OLDEST_STATUS:
        return _told("unknown", "unknown", f"the bridge has been silent for {age:.0f} s")
    values = _values(status)
    armed, state, stops = (values.get(key, UNKNOWN) for key in ("armed", "state", "stops"))
    title, kind = ("ARMED", "armed") if armed == "True" else ("not armed", "")
    reason = status.message.removeprefix(title).strip()  # it may say the same again
    return _told(title, kind, f"{reason}; {state}, stops: {stops}")


def _values(status: DiagnosticStatus) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


def _told(title: str, kind: str, text: str) -> dict[str, str]:
    return {"title": title, "kind": kind, "text": text}


def late_samples(timing: Any, status: Any) -> str:
    """Samples whose command came after the next sample, of all since the plant started.

    ``timing`` is the newest message on that topic, ``status`` that of the bridge to a rig, or None.
    """
    if status is not None:
        values = _values(status)
        return f"{values.get('samples skipped', '0')} of {values.get('samples', '0')}"
    if timing is None or len(timing.layout.dim) != 2:
        return UNKNOWN
    # Two rows of bins, the first one of the latency; the label of the bins says how wide they are.
    bins = timing.layout.dim[1]
    width = re.search(r"(\d+) us$", bins.label)
    if width is None or int(width[1]) == 0:
        return UNKNOWN
    latency = np.array(timing.data[: bins.size])
    return f"{int(latency[ceil(LATE / int(width[1])) :].sum())} of {int(latency.sum())}"
