"""Says how many samples were late, from the topic ``timing`` or the bridge's diagnostics."""

from __future__ import annotations

from typing import Any

import numpy as np

# The rows of ``timing``: latency from measurement to command first.
ROWS = 2
MICROSECONDS = 1e6


def late_samples(timing: Any, status: Any, sample_time: float = 0.001) -> str:
    """Samples whose command came after the next sample, of all since the plant started."""
    if status is not None:
        values = {each.key: each.value for each in status.values}
        return f"{values.get('samples skipped', '0')} of {values.get('samples', '0')}"
    if timing is None:
        return "–"
    latency = np.array(timing.data).reshape(ROWS, -1)[0]
    width = float(timing.layout.dim[1].label.split()[-2])
    first_late = int(np.ceil(sample_time * MICROSECONDS / width))
    return f"{int(latency[first_late:].sum())} of {int(latency.sum())}"
