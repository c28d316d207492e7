"""Values with standard errors and a verdict, as every identification returns them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from textwrap import fill
from typing import Any

from scipy.special import ndtri

from furuta.identification.verdict import NO, Verdict
from furuta.results.result import Result
from furuta.results.text import WIDTH, values_text
from furuta_model.parameters import ParameterError


@dataclass(frozen=True, repr=False, eq=False)
class Estimates(Result):
    """Values with standard errors by name, and a verdict, of any body.

    What is not determined is in ``undetermined``, with the reason. A value without a unit in
    ``units`` is a number, or its name ends in the unit. ``findings`` say how the recordings were
    interpreted.
    """

    values: dict[str, float]
    standard_errors: dict[str, float]
    undetermined: dict[str, str]
    units: dict[str, str]
    verdict: Verdict
    findings: list[str]
    details = frozenset({"covariance", "usable", "reasons", "residual"})

    @property
    def usable(self) -> str:
        """The verdict: yes, doubtful or no."""
        return self.verdict.usable

    @property
    def reasons(self) -> list[str]:
        """Why it is not better."""
        return self.verdict.reasons

    @property
    def is_usable(self) -> bool:
        """Whether the verdict is better than no."""
        return self.usable != NO

    def conf_int(self, level: float = 0.95) -> dict[str, tuple[float, float]]:
        """Lower and upper end of each value by name, at a confidence ``level`` between 0 and 1.

        Raises:
            ParameterError: The level is not between 0 and 1.
        """
        if not 0.0 < level < 1.0:
            raise ParameterError(f"level must be between 0 and 1, given {level}")
        wide = float(ndtri(0.5 + 0.5 * level))
        ends = {name: wide * error for name, error in self.standard_errors.items()}
        return {n: (self.values[n] - end, self.values[n] + end) for n, end in ends.items()}

    def require(self, force: bool = False) -> None:
        """Raise :class:`furuta.ParameterError` if it is not usable, unless it is forced."""
        if not force:
            self.verdict.require()

    def _by_name(self) -> dict[str, Any]:
        """Values, ``standard_errors`` and ``units`` by name, the verdict, and what was found."""
        return {
            **self.values,
            "standard_errors": self.standard_errors,
            "undetermined": self.undetermined,
            "units": self.units,
            **self.verdict._asdict(),
            "findings": self.findings,
        }

    def sentence(self) -> str:
        """Whether the values are usable."""
        return self.verdict.about("values")

    def table(self, values: Mapping[str, Any]) -> str:
        """The values with their errors, then how the recordings were interpreted."""
        own = {name: each for name, each in values.items() if name != "findings"}
        return f"{values_text(own)}\n\n{findings_text(values['findings'])}"


def findings_text(findings: Iterable[str]) -> str:
    """How recordings were interpreted, a paragraph each."""
    return "\n".join(fill(f"- {each}", WIDTH, subsequent_indent="  ") for each in findings)
