"""What recordings tell of an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from furuta.axis.identified_axis import IdentifiedAxis
from furuta.identification.axis.effects import Scales
from furuta.identification.axis.preparation import prepared
from furuta.identification.fitted import Fitted
from furuta.identification.unknowns import Key, Unknowns
from furuta_recordings.recording import Recording


@dataclass(frozen=True, repr=False, eq=False)
class AxisFit(Fitted, IdentifiedAxis):
    """What recordings tell of an axis: the fit, and what studies of its motion need."""

    def plot(self, axes: Any = None) -> Any:
        """Draw friction over speed, position and residual; see :meth:`Result.plot`."""
        from furuta.figures.friction import draw_friction
        from furuta.identification.axis.friction_curve import axis_followed, axis_friction

        return draw_friction(axis_friction(self), axis_followed(self), axes)

    def _prepared(self, run: Recording) -> tuple[Recording, float]:
        return prepared(run)

    def _unknowns(self, free: Sequence[Key]) -> Unknowns:
        scales = Scales(1.0, 1.0, 0.0, 1.0, 1.0, 1.0)
        return Unknowns(scales.unknown(key, self.fit.values) for key in free)

    def _by_name(self) -> dict[str, Any]:
        values = super()._by_name()
        findings = values.pop("findings")
        own = self._error(self.recordings[0], (("offset", 0), "drift"))
        about = {"resolution": self.resolution, "error": own}
        units = values["units"] | dict.fromkeys(about, self.position_unit)
        return {**values, "units": units, **about, "findings": findings}
