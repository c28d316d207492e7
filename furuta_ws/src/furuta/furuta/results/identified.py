"""Several joints that were identified each on its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from furuta.axis.joint_file import write_joint_file
from furuta.identification.axis.fit import AxisFit
from furuta.identification.axis.friction_curve import axis_friction
from furuta.identification.fitted import Fitted
from furuta.identification.verdict import NO, YES, Verdict
from furuta.results.result import Result
from furuta.results.text import table_text, values_text
from furuta_model.parameters import ParameterError

# What a row says of one of several joints.
OF_JOINT = ("inertia", "alpha0", "alpha1", "friction", "viscous", "gravity_sin", "gravity_cos")


@dataclass(frozen=True, repr=False, eq=False)
class Fits(Result):
    """Joints that were identified each on its own.

    Attributes:
        fits: What was found, by joint.
        refused: Why nothing was found, by joint.
    """

    fits: dict[str, Fitted]
    refused: dict[str, str]

    def _by_name(self) -> dict[str, Any]:
        """The ``joints``, with what was found of each."""
        refused = {
            joint: {"usable": NO, "reasons": [reason]} for joint, reason in self.refused.items()
        }
        return {"joints": {joint: fit._by_name() for joint, fit in self.fits.items()} | refused}

    def sentence(self) -> str:
        """How many of the joints are usable."""
        usable = sum(fit.verdict.usable != NO for fit in self.fits.values())
        return f"{usable} of {len(self.fits) + len(self.refused)} joints are usable."

    def table(self, values: Mapping[str, Any]) -> str:
        """A row for each joint, then what speaks against it."""
        rows, doubts = [], dict(self.refused)
        for joint, fit in self.fits.items():
            known = {n: fit.values[n] for n in OF_JOINT if n in fit.values}
            titled = {f"{n.replace('_', ' ')} [{fit.unit(n)}]": v for n, v in known.items()}
            rows.append({"joint": joint, "usable": fit.verdict.usable, **titled})
            if fit.verdict.reasons:
                doubts[joint] = "; ".join(fit.verdict.reasons)
        return "\n\n".join(filter(None, (table_text(rows) if rows else "", values_text(doubts))))

    @property
    def is_usable(self) -> bool:
        """Whether all of the joints are."""
        return not self.refused and all(fit.is_usable for fit in self.fits.values())

    def require(self, force: bool = False) -> None:
        """Raise :class:`furuta.ParameterError` if a joint is not usable."""
        refused = [f"{joint}: {reason}" for joint, reason in self.refused.items()]
        refused += [
            f"{joint}: not usable: {'; '.join(fit.verdict.reasons)}; --force uses it all the same"
            for joint, fit in self.fits.items()
            if fit.verdict.usable == NO and not force
        ]
        Verdict(NO if refused else YES, refused).require()

    def write(self, path: str | Path) -> None:
        """Write a joint file with all joints.

        Raises:
            ParameterError: Of a joint no friction was found, or two names are one for ROS.
        """
        write_joint_file(path, self._axes())

    def plot(self, axes: Any = None) -> Any:
        """Draw the friction of each joint over its speed; see :meth:`Result.plot`."""
        from furuta.figures.friction import draw_joints

        if not self.fits:
            raise ParameterError(f"there is nothing to draw. {self.sentence()}")
        curves = {joint: axis_friction(fit) for joint, fit in self._axes().items()}
        return draw_joints(curves, axes)

    def _axes(self) -> dict[str, AxisFit]:
        """The fits, of which all are of an axis."""
        found = {joint: fit for joint, fit in self.fits.items() if isinstance(fit, AxisFit)}
        if len(found) < len(self.fits):
            raise ParameterError("only an axis that was identified alone has a joint file")
        return found
