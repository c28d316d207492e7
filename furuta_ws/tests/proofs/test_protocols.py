"""Every way that lock-step and arming can go, within bounds: docs/safety.md."""

import pytest
from proofs import arming_world, lockstep_world
from proofs.arming_world import Budget, Rig
from proofs.explorer import Explored, explore, mutated
from proofs.lockstep_world import Bounds, World

from furuta_control.controller_node import ControllerNode
from furuta_hw.emulator.firmware import Firmware
from furuta_hw.guard import Guard
from furuta_sim.lockstep import LockStep


def lockstep(bounds: Bounds) -> Explored:
    with lockstep_world.own_clock():
        return explore(
            World(bounds), lockstep_world.steps, lambda w: w.problem, World.key, ends=True
        )


@pytest.mark.parametrize(
    "bounds",
    [
        Bounds(3),
        Bounds(3, losses=1),
        Bounds(2, early=1),
        Bounds(3, resets=1),
        *(
            pytest.param(bounds, marks=pytest.mark.long)
            for bounds in (
                Bounds(3, losses=3),
                Bounds(3, losses=1, early=1),
                Bounds(3, losses=1, restarts=1),
                Bounds(4, restarts=2),
                Bounds(3, losses=1, early=1, resets=1),
                Bounds(4, losses=3, restarts=2, early=1, resets=1),
            )
        ),
    ],
    ids=str,
)
def test_every_command_answers_its_own_sample(bounds: Bounds) -> None:
    """With its own estimate, whatever is lost, repeated or restarted; it never stands still."""
    explored = lockstep(bounds)
    print(explored.states, "states,", explored.transitions, "transitions")
    assert not explored.violation, explored


MUTANTS: list[tuple[type, str, str, Bounds]] = [
    (LockStep, "if 0 < sent < self._began:", "if False:", Bounds(3, resets=1)),
    (LockStep, "elif self._is_repeated:", "elif False:", Bounds(3, losses=1, early=1)),
    (LockStep, "unchanged >= SETTLE_TIME", "True", Bounds(3, losses=1, early=1)),
    (
        ControllerNode,
        "if self._stamp != self._answered_stamp:",
        "if self._stamp != NEVER:",
        Bounds(3, losses=1),
    ),
    (ControllerNode, "if stamp == self._answered_stamp:", "if False:", Bounds(2, losses=1)),
    (ControllerNode, "self._is_estimated or is_anew or ", "False and ", Bounds(2)),
]


@pytest.mark.parametrize(("kind", "old", "new", "bounds"), MUTANTS)
def test_a_fault_of_the_lockstep_is_found(kind: type, old: str, new: str, bounds: Bounds) -> None:
    """Faults that the code had, put back, and a rule taken out of it."""
    with mutated(kind, old, new):
        explored = lockstep(bounds)
    print(explored.states, explored.violation)
    assert explored.violation


def arming(budget: Budget) -> Explored:
    with arming_world.own_clock():
        return explore(Rig(budget), arming_world.steps, lambda rig: rig.problem, Rig.key)


@pytest.mark.parametrize(
    "budget",
    [
        Budget(4, disarms=0, repetitions=0),
        *(
            pytest.param(budget, marks=pytest.mark.long)
            for budget in (Budget(5, losses=0, repetitions=0, deaths=0), Budget(4))
        ),
    ],
    ids=str,
)
def test_a_rig_is_never_armed_unasked(budget: Budget) -> None:
    """And at 0 V within the watchdog after a user, the host or the line has ended it."""
    explored = arming(budget)
    print(explored.states, "states,", explored.transitions, "transitions")
    assert not explored.violation, explored


@pytest.mark.parametrize(
    ("kind", "old", "new"),
    [
        (Firmware, "return (self.number - sample) % 2**32 < self.watchdog", "return True"),
        (Firmware, "(self.number - self.answered) % 2**32 >= self.watchdog", "False"),
        (Firmware, "self.armed and accepted and", "accepted and"),
        pytest.param(
            *(Guard, "if not self.armed or self._is_observer_missing():", "if False:"),
            marks=pytest.mark.long,
        ),
    ],
)
def test_a_fault_of_arming_is_found(kind: type, old: str, new: str) -> None:
    """Faults of the firmware's rules, and of the guard."""
    with mutated(kind, old, new):
        explored = arming(Budget(5, deaths=0))
    print(explored.states, explored.violation)
    assert explored.violation
