"""Visits every state that a system can reach, breadth first."""

import __future__

import inspect
import sys
from collections import deque
from collections.abc import Callable, Hashable, Iterable, Iterator
from contextlib import contextmanager
from textwrap import dedent
from typing import Any, NamedTuple
from unittest.mock import patch


class Explored(NamedTuple):
    """What an exploration found.

    Attributes:
        states: Number of different states.
        transitions: Number of steps between them.
        violation: What is wrong in the first bad state, or an empty string.
        trace: The steps that lead there.
    """

    states: int
    transitions: int
    violation: str = ""
    trace: tuple[str, ...] = ()


def explore(
    initial: Any,
    steps: Callable[[Any], Iterable[tuple[str, Any]]],
    problem: Callable[[Any], str],
    key: Callable[[Any], Hashable],
    ends: bool = False,
) -> Explored:
    """Visit all states; ends at the first one that has a ``problem``, on a shortest way.

    ``steps`` gives the states that follow a state, each with the name of the step. Two states with
    the same ``key`` behave alike. A state from which nothing follows must be ``done``. With
    ``ends`` a way to one that is done must lead from every state.
    """
    parents: dict[Hashable, tuple[Hashable, str] | None] = {key(initial): None}
    before: dict[Hashable, list[Hashable]] = {}
    waiting, finished = deque([initial]), []
    transitions = 0

    def result(violation: str, at: Hashable) -> Explored:
        trace: list[str] = []
        while (parent := parents[at]) is not None:
            at, name = parent
            trace.insert(0, name)
        return Explored(len(parents), transitions, violation, tuple(trace))

    while waiting:
        state = waiting.popleft()
        here = key(state)
        if violation := problem(state):
            return result(violation, here)
        if state.done:
            finished.append(here)
        moves = 0
        for name, following in steps(state):
            moves += 1
            there = key(following)
            if ends:
                before.setdefault(there, []).append(here)
            if there not in parents:
                parents[there] = (here, name)
                waiting.append(following)
        transitions += moves
        if moves == 0 and not state.done:
            return result("deadlock", here)
    for trapped in _without_end(parents, before, finished) if ends else ():
        return result("stands still for good", trapped)
    return Explored(len(parents), transitions)


def _without_end(
    states: Iterable[Hashable],
    before: dict[Hashable, list[Hashable]],
    finished: list[Hashable],
) -> Iterator[Hashable]:
    """The states from which no way leads to a ``finished`` one."""
    ending, waiting = set(finished), deque(finished)
    while waiting:
        for earlier in before.get(waiting.popleft(), ()):
            if earlier not in ending:
                ending.add(earlier)
                waiting.append(earlier)
    return (state for state in states if state not in ending)


def shallow(instance: Any) -> Any:
    """An instance with the same attributes; faster than ``copy.copy``."""
    new = type(instance).__new__(type(instance))
    new.__dict__.update(instance.__dict__)
    return new


@contextmanager
def mutated(kind: type, old: str, new: str) -> Iterator[None]:
    """Inside the ``with`` block the class has ``new`` in place of ``old`` in its source."""
    source = inspect.getsource(kind)
    assert source.count(old) == 1, f"{kind.__name__} has {source.count(old)} times {old!r}"
    names = vars(sys.modules[kind.__module__])
    with patch.dict(names):
        changed_source = dedent(source.replace(old, new))
        exec(compile(changed_source, "mutant", "exec", __future__.annotations.compiler_flag), names)
        changed = vars(names[kind.__name__])
    functions = {name: value for name, value in changed.items() if inspect.isfunction(value)}
    with patch.multiple(kind, **functions):
        yield
