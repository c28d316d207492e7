"""Scheduling of ``furuta run``: what the system granted is what is reported."""

import os
import subprocess
from io import StringIO
from types import SimpleNamespace
from typing import Any

import pytest

from furuta_bringup.graph.scheduling import may_have_priority

pytestmark = pytest.mark.realtime


def test_what_is_granted_or_refused_is_printed(processes: Any) -> None:
    """Whichever it is on this machine; the run goes on, and says how late samples were."""
    status, out, err = processes.run("run", "--seconds", "1", "--priority", "10", "--lock-memory")
    assert status == 0, err
    granted = "SCHED_FIFO priority 10: granted, SCHED_FIFO 10" in out
    assert granted or "SCHED_FIFO priority 10: REFUSED, Operation not permitted: needs" in out
    assert "memory lock: granted" in out or "memory lock: REFUSED" in out
    assert "latency   50 % within" in out


@pytest.mark.parametrize("options", [(), ("--lockstep",), ("--priority", "5")], ids=str)
def test_beside_a_page_a_graph_takes_a_priority_where_it_may(
    furuta: Any, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...]
) -> None:
    """Not in lock-step, where it would leave nothing for the page, nor beside one of its own."""
    page = SimpleNamespace(stdout=StringIO("http://127.0.0.1:8080\n"))
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: page)
    started: list[str] = []
    monkeypatch.setattr(os, "execv", lambda path, given: started.extend(given[2:]), raising=False)
    assert furuta("view", "--no-open", "--", *options)[0] == 0
    prior = ("--priority", "80") if not options and may_have_priority(80) else ()
    assert started == [*prior, *options]
    assert os.sched_getscheduler(0) == os.SCHED_OTHER
