"""Scheduling of a process that must be on time: priority and memory.

Applied before ROS starts, so that its threads inherit the priority.
"""

import ctypes
import os
from collections.abc import Callable
from typing import NamedTuple

# mlockall(2): what is mapped now, and what will be.
MCL_CURRENT, MCL_FUTURE = 1, 2


class Scheduling(NamedTuple):
    """What the process requests from the operating system: nothing, by default."""

    priority: int = 0  # of SCHED_FIFO, 1 to 99; 0 leaves the scheduler as it is
    lock_memory: bool = False  # keep all pages in memory


class RequestResult(NamedTuple):
    """One request, whether it was granted, and the state afterwards or the reason."""

    request: str
    granted: bool
    detail: str

    def __str__(self) -> str:
        return f"{self.request}: {'granted' if self.granted else 'REFUSED'}, {self.detail}"


def apply_scheduling(requested: Scheduling) -> list[RequestResult]:
    """Make the requests and return the results, each as the system reports it afterwards."""
    results = []
    if requested.priority:
        results.append(_set_priority(requested.priority))
    if requested.lock_memory:
        results.append(_lock_memory())
    return results


def may_have_priority(priority: int) -> bool:
    """Whether the system would grant this process a real-time priority."""
    before = os.sched_getscheduler(0), os.sched_getparam(0)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
        os.sched_setscheduler(0, *before)
    except OSError:
        return False
    return True


def _set_priority(priority: int) -> RequestResult:
    def request() -> str:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
        policy = "SCHED_FIFO" if os.sched_getscheduler(0) == os.SCHED_FIFO else "another policy"
        return f"{policy} {os.sched_getparam(0).sched_priority}"

    needs = "needs CAP_SYS_NICE or an rtprio limit (ulimit -r)"
    return _result_of(f"SCHED_FIFO priority {priority}", request, needs)


def _lock_memory() -> RequestResult:
    def request() -> str:
        libc = ctypes.CDLL(None, use_errno=True)
        if libc.mlockall(MCL_CURRENT | MCL_FUTURE):
            number = ctypes.get_errno()
            raise OSError(number, os.strerror(number))
        return f"{_locked_memory()} locked"

    return _result_of("memory lock", request, "needs CAP_IPC_LOCK or a memlock limit (ulimit -l)")


def _locked_memory() -> str:
    with open("/proc/self/status") as status:
        return next(line.split(":")[1].strip() for line in status if line.startswith("VmLck"))


def _result_of(name: str, request: Callable[[], str], hint: str) -> RequestResult:
    """Make a request; ``hint`` tells the user what to do if the system refuses it."""
    try:
        return RequestResult(name, True, request())
    except OSError as error:
        return RequestResult(name, False, f"{error.strerror}: {hint}")
