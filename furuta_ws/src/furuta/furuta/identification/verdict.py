"""Whether what was identified may be used, and why not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from furuta_model.parameters import ParameterError

YES, DOUBTFUL, NO = "yes", "doubtful", "no"
# From the best to the worst.
GRADES = (YES, DOUBTFUL, NO)
# Size of the residuals in the noise of the sensor that a fit has which explains the recording: an
# axis at rest keeps an error of up to half a count.
EXPLAINED = 3.0**0.5


class Limits(NamedTuple):
    """Parts of something that a model may leave over until it is doubtful, and of no use."""

    doubtful: float
    useless: float


# For every body: of the motion that forces cause within a segment, of the torque, and of the motion
# of a free run, in which errors grow. Residuals that last are errors of the model.
LIMITS = {
    "motion": Limits(0.005, 0.15),
    "torque": Limits(0.005, 0.15),
    "free run": Limits(0.2, 0.5),
    "free run, coloured": Limits(0.05, 0.5),
}


class Residual(NamedTuple):
    """What a model leaves: in ``noises`` of the sensor, and as a ``part`` of motion or torque."""

    of: str
    noises: float
    part: float

    @property
    def unexplained(self) -> float:
        """The part that is left over; 0 where that is no more than noise."""
        return self.part if self.noises > EXPLAINED else 0.0

    @property
    def grade(self) -> str:
        """What it says of the values."""
        limits, part = LIMITS[self.of], self.unexplained
        return NO if part > limits.useless else DOUBTFUL if part > limits.doubtful else YES

    def doubts(self) -> Iterator[tuple[str, str]]:
        """What it says against the values, if anything."""
        if self.grade != YES:
            noises = f", {self.noises:.1f} times its noise" if self.noises < float("inf") else ""
            yield (
                self.grade,
                f"the model leaves {100.0 * self.part:.1f} % of the {self.of}{noises}: something "
                "acts that it does not have",
            )


class Verdict(NamedTuple):
    """``usable`` is yes, doubtful or no; every reason that makes it worse than yes."""

    usable: str
    reasons: list[str]

    @classmethod
    def of(cls, doubts: Iterable[tuple[str, str]]) -> Verdict:
        """The worst of all doubts, each a grade and its reason."""
        given = list(doubts)
        worst = max((GRADES.index(grade) for grade, _ in given), default=0)
        return cls(GRADES[worst], [reason for _, reason in given])

    def require(self, otherwise: str = "") -> None:
        """Raise :class:`ParameterError` for what is of no use; ``otherwise`` says what to do."""
        if self.usable == NO:
            raise ParameterError(f"not usable: {'; '.join(self.reasons)}{otherwise}")

    def about(self, what: str) -> str:
        """As a sentence on something, such as values."""
        verb = "are" if what.endswith("s") else "is"
        if self.usable == YES:
            return f"The {what} {verb} usable."
        grade = "not usable" if self.usable == NO else self.usable
        return f"The {what} {verb} {grade}: {'; '.join(self.reasons)}."

    def sentence(self) -> str:
        """As one line."""
        return "; ".join([self.usable, *self.reasons])
