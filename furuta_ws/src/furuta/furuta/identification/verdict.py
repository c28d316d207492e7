"""Whether what was identified may be used, and why not."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, Protocol

from furuta_model.parameters import ParameterError

YES, DOUBTFUL, NO = "yes", "doubtful", "no"
# From the best to the worst.
GRADES = (YES, DOUBTFUL, NO)


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

    def sentence(self) -> str:
        """As one line."""
        return "; ".join([self.usable, *self.reasons])


class Identified(Protocol):
    """What every fit has: values and standard errors by name, and what is said of them."""

    @property
    def values(self) -> dict[str, float]:
        """What is determined."""

    @property
    def standard_errors(self) -> dict[str, float]:
        """Those of the values."""

    @property
    def undetermined(self) -> dict[str, str]:
        """Why the rest is not determined."""

    @property
    def verdict(self) -> Verdict:
        """Whether the values are usable."""

    @property
    def findings(self) -> list[str]:
        """How the content of the recording was interpreted."""

    def unit(self, name: str) -> str:
        """The unit of a value; empty for a number."""
