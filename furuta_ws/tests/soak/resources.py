"""Memory, open files and threads of processes, from /proc."""

import os
from collections import defaultdict
from pathlib import Path
from time import monotonic

from soak.oracles import growth
from soak.record import Record

# Time between two samples [s]. Processes that live for fewer samples have no trend.
PERIOD = 1.0
SHORTEST = 20


def resources(pid: int) -> dict[str, float]:
    """Resident memory [MB], open files and threads of a process. Raises OSError if it is gone."""
    status = Path(f"/proc/{pid}/status").read_text()
    fields = dict(line.split(":", 1) for line in status.splitlines() if ":" in line)
    return {
        "memory": int(fields["VmRSS"].split()[0]) / 1024.0,
        "files": len(os.listdir(f"/proc/{pid}/fd")),
        "threads": int(fields["Threads"]),
    }


class ResourceMonitor:
    """Samples the resources of named processes, and checks that they are flat at the end."""

    def __init__(self) -> None:
        self._series: dict[tuple[str, int], list[dict[str, float]]] = defaultdict(list)
        self._due = 0.0

    def sample(self, processes: dict[str, int]) -> None:
        """Take a sample of the processes, given as names with process numbers, if one is due."""
        if monotonic() < self._due:
            return
        self._due = monotonic() + PERIOD
        for name, pid in processes.items():
            try:
                self._series[name, pid].append(resources(pid))
            except (OSError, KeyError):
                continue  # it has ended, or is a zombie

    def check(self, record: Record) -> None:
        """Check each process that lived long enough."""
        for (name, _), series in self._series.items():
            if len(series) >= SHORTEST:
                problem = growth(series)
                record.check("flat", f"{name}: {problem}" if problem else "")
