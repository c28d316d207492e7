"""Records what a slice of a campaign did, and what its oracles found."""

from collections import Counter
from time import monotonic
from typing import Any, NamedTuple

import numpy as np

# Failures of one oracle in one slice that are kept with their details; all are counted.
KEPT_FAILURES = 5


class Slice(NamedTuple):
    """A part of a campaign: ``number`` and ``seed`` determine its random choices.

    It ends after ``seconds``, or after ``steps`` if they are given.
    """

    campaign: str
    number: int
    seed: int
    seconds: float
    steps: int | None = None

    @property
    def name(self) -> str:
        """The name by which ``--slice`` repeats it."""
        return f"{self.campaign}:{self.number}"

    def random(self) -> np.random.Generator:
        """The slice's source of random numbers; the same for the same seed and number."""
        return np.random.default_rng([self.seed, self.number, *self.campaign.encode()])


class Record:
    """Counts of one slice. ``step`` is the number of the current random choice."""

    def __init__(self, part: Slice) -> None:
        self.part = part
        self.step = 0
        self._end = monotonic() + part.seconds
        self.checks: Counter[str] = Counter()
        self.broken: Counter[str] = Counter()
        self.failures: list[dict[str, Any]] = []  # which oracle, at which step, and what is wrong

    def next_step(self) -> bool:
        """Begin the next step; False if the slice has ended."""
        if self.step == self.part.steps or (self.part.steps is None and monotonic() > self._end):
            return False
        self.step += 1
        return True

    def check(self, oracle: str, problem: str) -> None:
        """Count a check of an oracle; ``problem`` is empty if it holds."""
        self.checks[oracle] += 1
        if problem:
            self.broken[oracle] += 1
            if self.broken[oracle] <= KEPT_FAILURES:
                self.failures.append({"oracle": oracle, "step": self.step, "detail": problem})

    def as_json(self) -> dict[str, Any]:
        """Everything recorded, for a JSON file."""
        return {
            "slice": self.part.name,
            "seed": self.part.seed,
            "steps": self.step,
            "checks": self.checks,
            "broken": self.broken,
            "failures": self.failures,
        }
