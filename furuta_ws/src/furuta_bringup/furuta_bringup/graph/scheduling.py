"""Scheduling of a process that must be on time: priority and memory.

Applied before ROS starts, so that its threads inherit the priority.
"""

import ctypes
import os
from collections.abc import Callable, Iterator
from typing import NamedTuple

# mlockall(2): what is mapped now, and what will be.
MCL_CURRENT, MCL_FUTURE = 1, 2


class Scheduling(NamedTuple):
    """What the process requests from the operating system: nothing, by default."""

    priority: int = 0  # of SCHED_FIFO, 1 to 99; 0 leaves the scheduler as it is
    lock_memory: bool = False  # keep all pages in memory


def apply_scheduling(requested: Scheduling) -> Iterator[str]:
    """Make the requests; yields for each a line with the state afterwards or the reason."""
    if requested.priority:
        request = f"SCHED_FIFO priority {requested.priority}"
        needs = "CAP_SYS_NICE or an rtprio limit (ulimit -r)"
        yield _result_of(request, lambda: _set_priority(requested.priority), needs)
    if requested.lock_memory:
        needs = "CAP_IPC_LOCK or a memlock limit (ulimit -l)"
        yield _result_of("memory lock", _lock_memory, needs)


def may_have_priority(priority: int) -> bool:
    """Whether the system would grant this process a real-time priority."""
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        _set_priority(priority)
        os.sched_setscheduler(0, *before)
    except OSError:
        return False
    return True


def _set_priority(priority: int) -> str:
    """Set the priority, and return that which the system reports."""
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    policy = "SCHED_FIFO" if os.sched_getscheduler(0) == os.SCHED_FIFO else "another policy"
    return f"{policy} {os.sched_getparam(0).sched_priority}"


def _lock_memory() -> str:
    """Lock all memory, and return how much the system reports as locked."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mlockall(MCL_CURRENT | MCL_FUTURE):
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    with open("/proc/self/status", encoding="ascii") as status:
        locked = next(line.split(":")[1].strip() for line in status if line.startswith("VmLck"))
    return f"{locked} locked"


def _result_of(request: str, make: Callable[[], str], needs: str) -> str:
    try:
        return f"{request}: granted, {make()}"
    except OSError as error:
        return f"{request}: REFUSED, {error.strerror}: needs {needs}"
