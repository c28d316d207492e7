"""Scheduling of ``furuta run``: what the system granted is what is reported."""

from typing import Any

import pytest

pytestmark = pytest.mark.realtime


def test_what_is_granted_or_refused_is_printed(processes: Any) -> None:
    """Whichever it is on this machine; the run goes on, and says how late samples were."""
    status, out, err = processes.run("run", "--seconds", "1", "--priority", "10", "--lock-memory")
    assert status == 0, err
    granted = "SCHED_FIFO priority 10: granted, SCHED_FIFO 10" in out
    assert granted or "SCHED_FIFO priority 10: REFUSED, Operation not permitted: needs" in out
    assert "memory lock: granted" in out or "memory lock: REFUSED" in out
    assert "latency   50 % within" in out
