"""Every way that lock-step, publishers and arming can go, within bounds: docs/safety.md."""

from typing import Any
from unittest.mock import patch

import pytest
from proofs import arming_world, lockstep_world, publisher_world
from proofs.arming_world import Budget, Rig
from proofs.explorer import Explored, explore, mutated
from proofs.lockstep_world import Bounds, World
from proofs.publisher_world import Publishers

from furuta_control.estimate_matching import EstimateMatching
from furuta_hw.guard import Guard
from furuta_ros import one_publisher
from furuta_ros.one_publisher import OnePublisher
from furuta_sim.emulator.firmware import Firmware
from furuta_sim.lockstep import LockStep


def lockstep(bounds: Bounds) -> Explored:
    with lockstep_world.own_clock():
        return explore(World(bounds), lockstep_world.steps, lambda w: w.violation, World.key)


def publishers() -> Explored:
    with patch.object(one_publisher, "MARGIN", publisher_world.MARGIN):
        return explore(
            Publishers(), publisher_world.steps, lambda state: state.violation, Publishers.key
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


LATE = "self._late_possible and 0 < self._plant.message_age.sent < self._began"
OLD = "return sent < self._sent - (0 if uncertain else REPETITION_TIME)"
MUTANTS: list[tuple[type, str, str, Bounds]] = [
    (LockStep, f"if {LATE}:", "if False:", Bounds(3, resets=1)),
    (LockStep, "if self._unanswered == 0:", "if True:", Bounds(2, early=1)),
    (LockStep, "if not self._waiting:", "if False:", Bounds(2, early=1)),
    (EstimateMatching, OLD, "return False", Bounds(3, losses=1)),
    (EstimateMatching, OLD, "return uncertain and sent < self._sent", Bounds(3, losses=1)),
    (EstimateMatching, "if anew or self._previous_uncertain", "if anew", Bounds(3, 1, 1)),
    (EstimateMatching, "if sent < self._sent_last + REPETITION_TIME:", "if True:", Bounds(3, 1, 1)),
]


@pytest.mark.parametrize(("kind", "old", "new", "bounds"), MUTANTS)
def test_a_fault_of_the_lockstep_is_found(kind: type, old: str, new: str, bounds: Bounds) -> None:
    """Faults that the code had, put back, and a rule taken out of it."""
    with mutated(kind, old, new), lockstep_world.own_clock():
        explored = explore(World(bounds), lockstep_world.steps, lambda w: w.violation, World.key)
    print(explored.states, explored.violation)
    assert explored.violation


def test_no_other_publisher_is_accepted() -> None:
    """While the first one is there, however their numbers run and whatever is lost."""
    explored = publishers()
    print(explored.states, "states,", explored.transitions, "transitions")
    assert not explored.violation, explored


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("and abs(number - self._next) <= MARGIN", "and False"),
        ("if were_several or len(self._listed) > 1:", "if False:"),
        ("if self._now() - self._several_until < SETTLING_TIME:", "if False:"),
    ],
)
def test_a_fault_of_the_publishers_rule_is_found(old: str, new: str) -> None:
    """Among them that anybody is accepted after a refusal."""
    with (
        patch.object(one_publisher, "MARGIN", publisher_world.MARGIN),
        mutated(OnePublisher, old, new),
    ):
        explored: Any = explore(
            Publishers(), publisher_world.steps, lambda state: state.violation, Publishers.key
        )
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
