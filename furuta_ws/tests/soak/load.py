"""Measures how busy the machine is during a soak."""

from __future__ import annotations

import os
from pathlib import Path
from threading import Event, Thread
from types import TracebackType

# Time between two samples of the load average [s].
PERIOD = 5.0


class LoadMeter:
    """Samples the load average on a thread, and counts the time of all cores."""

    def __init__(self) -> None:
        self._averages = [os.getloadavg()[0]]
        self._ended = Event()
        self._thread = Thread(target=self._sample, daemon=True)
        self._begin = _core_times()

    def __enter__(self) -> LoadMeter:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self._ended.set()
        self._thread.join()

    def _sample(self) -> None:
        while not self._ended.wait(PERIOD):
            self._averages.append(os.getloadavg()[0])

    def summary(self) -> dict[str, float]:
        """Cores, their busy fraction, and the mean and largest load average over a minute."""
        busy, total = (b - a for a, b in zip(self._begin, _core_times(), strict=True))
        return {
            "cores": float(os.cpu_count() or 1),
            "busy_fraction": busy / total if total else 0.0,
            "mean_load": sum(self._averages) / len(self._averages),
            "largest_load": max(self._averages),
        }


def _core_times() -> tuple[float, float]:
    """Time that all cores were busy, and all time, in ticks since boot."""
    fields = [int(each) for each in Path("/proc/stat").read_text().splitlines()[0].split()[1:9]]
    idle = fields[3] + fields[4]
    return float(sum(fields) - idle), float(sum(fields))
