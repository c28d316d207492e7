"""Friction that was measured on a rig by ramps and slides."""

from __future__ import annotations

from typing import Any

from furuta.results.result import Found
from furuta_hw.commissioning.friction import FrictionLevels


class MeasuredFriction(Found):
    """Friction of the arm: levels [V] by direction, ``viscous`` [V s/rad], and what follows.

    Fields: those of ``FrictionLevels``, ``alpha0``, ``alpha1`` [V] and ``asymmetry``.
    """

    found: FrictionLevels

    def _by_name(self) -> dict[str, Any]:
        """Levels by direction, and the parameters of friction that follow, with ``units``."""
        derived = {name: getattr(self.found, name) for name in ("alpha0", "alpha1", "asymmetry")}
        values = {**self.found._asdict(), **derived}
        units = {**dict.fromkeys(values, "V"), "viscous": "V s/rad", "asymmetry": ""}
        return {**values, "units": units}

    def sentence(self) -> str:
        """The levels at which the arm slides and breaks away."""
        level, stiction = self.found.alpha0, self.found.alpha1
        return (
            f"The arm slides at {level:.3g} V and breaks away {stiction:.3g} V above that, with "
            f"{self.found.viscous:.3g} V s/rad of viscous friction."
        )

    def plot(self, axes: Any = None) -> Any:
        """Draw the levels over speed; see :meth:`Result.plot`."""
        from furuta.figures.friction import draw_levels

        levels = self.found
        by_direction = {
            1: (levels.coulomb_positive, levels.stiction_positive),
            -1: (levels.coulomb_negative, levels.stiction_negative),
        }
        return draw_levels(by_direction, levels.viscous, axes)
