"""What the operating system gives a process that must be on time, and what it refuses.

Asked for before ROS starts, so that its threads inherit priority and cores.
"""

from __future__ import annotations

import ctypes
import gc
import os
from collections.abc import Callable
from typing import NamedTuple

# mlockall(2): what is mapped now, and what will be.
MCL_CURRENT, MCL_FUTURE = 1, 2


class Scheduling(NamedTuple):
    """What is asked for: nothing, by default."""

    priority: int = 0  # of SCHED_FIFO, 1 to 99; 0 leaves the scheduler as it is
    cores: tuple[int, ...] = ()  # that the process may run on; () leaves them as they are
    lock_memory: bool = False  # keep all pages in memory
    collect_garbage: bool = True  # Python's cyclic collector, which stops a process for ms


class Granted(NamedTuple):
    """One thing asked for, and what came of it."""

    what: str
    granted: bool
    detail: str

    def __str__(self) -> str:
        return f"{self.what}: {'granted' if self.granted else 'REFUSED'}, {self.detail}"


def schedule(asked: Scheduling) -> list[Granted]:
    """Ask for all of it and tell what was got, as the system itself says afterwards."""
    got = []
    if asked.priority:
        got.append(_priority(asked.priority))
    if asked.cores:
        got.append(_cores(asked.cores))
    if asked.lock_memory:
        got.append(_lock_memory())
    if not asked.collect_garbage:
        gc.disable()
        got.append(Granted("garbage collector off", not gc.isenabled(), "memory in cycles stays"))
    return got


def _priority(priority: int) -> Granted:
    what = f"SCHED_FIFO priority {priority}"

    def ask() -> str:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
        policy = "SCHED_FIFO" if os.sched_getscheduler(0) == os.SCHED_FIFO else "another policy"
        return f"{policy} {os.sched_getparam(0).sched_priority}"

    return _asked(what, ask, "needs CAP_SYS_NICE or an rtprio limit (ulimit -r)")


def _cores(cores: tuple[int, ...]) -> Granted:
    def ask() -> str:
        os.sched_setaffinity(0, cores)
        return f"runs on {sorted(os.sched_getaffinity(0))}"

    return _asked(f"cores {sorted(cores)}", ask, f"there are {sorted(os.sched_getaffinity(0))}")


def _lock_memory() -> Granted:
    def ask() -> str:
        libc = ctypes.CDLL(None, use_errno=True)
        if libc.mlockall(MCL_CURRENT | MCL_FUTURE):
            number = ctypes.get_errno()
            raise OSError(number, os.strerror(number))
        return f"{_locked()} locked"

    return _asked("memory lock", ask, "needs CAP_IPC_LOCK or a memlock limit (ulimit -l)")


def _locked() -> str:
    with open("/proc/self/status") as status:
        return next(line.split(":")[1].strip() for line in status if line.startswith("VmLck"))


def _asked(what: str, ask: Callable[[], str], needs: str) -> Granted:
    try:
        return Granted(what, True, ask())
    except OSError as error:
        return Granted(what, False, f"{error.strerror}: {needs}")
