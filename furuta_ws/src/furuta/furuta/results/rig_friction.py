"""Friction that was measured on a rig by ramps and slides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from furuta.results.result import Result
from furuta_hw.commissioning.friction import FrictionLevels


@dataclass(frozen=True, repr=False)
class MeasuredFriction(Result, FrictionLevels):
    """Friction of the arm: levels [V] by direction, ``viscous`` [V s/rad], and what follows.

    Fields: those of ``FrictionLevels``, ``alpha0``, ``alpha1`` [V] and ``asymmetry``.
    """

    also = ("alpha0", "alpha1", "asymmetry")

    def _by_name(self) -> dict[str, Any]:
        """Levels by direction, and the parameters of friction that follow, with ``units``."""
        values = super()._by_name()
        units = {**dict.fromkeys(values, "V"), "viscous": "V s/rad", "asymmetry": ""}
        return {**values, "units": units}

    def sentence(self) -> str:
        """The levels at which the arm slides and breaks away."""
        return (
            f"The arm slides at {self.alpha0:.3g} V and breaks away {self.alpha1:.3g} V above "
            f"that, with {self.viscous:.3g} V s/rad of viscous friction."
        )

    def plot(self, axes: Any = None) -> Any:
        """Draw the levels over speed; see :meth:`Result.plot`."""
        from furuta.figures.friction import draw_levels

        by_direction = {
            1: (self.coulomb_positive, self.stiction_positive),
            -1: (self.coulomb_negative, self.stiction_negative),
        }
        return draw_levels(by_direction, self.viscous, axes)
