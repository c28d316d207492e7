"""An identified axis as a joint file keeps it: what studies of its motion need of a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from furuta.axis.axis import NO_RULE, Axis, Controller, IntegralRule
from furuta.axis.gains import per_unit
from furuta.identification.estimates import Estimates
from furuta.identification.verdict import GRADES, Verdict
from furuta_model.parameters import ParameterError

# Axes that a recording may have come from, of which a study tells.
DRAWS = 100
# Fields of a file that are numbers or text as they are.
PLAIN = ("joint", "interval", "position_unit", "torque_unit", "resolution", "hidden")


@dataclass(frozen=True, repr=False, eq=False)
class IdentifiedAxis(Estimates):
    """What recordings told of an axis: fields beyond those of :class:`Estimates`.

    ``names``, ``means`` (p,) and ``covariance`` (p, p) are those of all fitted unknowns.
    ``interval`` [s] is the time between samples, ``recorded_unit`` the unit that the recording has
    for the position, with its size in ``position_unit``. ``resolution`` is the smallest change of
    the position, ``hidden`` the largest stiction above the Coulomb level that would not show.
    """

    names: tuple[str, ...]
    covariance: np.ndarray
    means: np.ndarray = field(repr=False)
    joint: str
    interval: float
    position_unit: str
    torque_unit: str
    recorded_unit: tuple[str, float]
    resolution: float
    hidden: float

    def require(self, force: bool = False) -> None:
        """Raise :class:`furuta.ParameterError` if it is not usable, unless it is forced."""
        if not force:
            self.verdict.require("; --force uses it all the same")

    def axis(self, law: str | None = None) -> Axis:
        """The axis, without what belongs to the recording: offset and drift.

        Args:
            law: coulomb, stiction or stribeck. None takes stribeck, or stiction if the recording
                shows that friction falls at once.

        Raises:
            ParameterError: The law has a bristle, which the recording does not show.
        """
        from furuta.axis.draws import identified_axis

        return identified_axis(self, law)

    def draws(self, number: int = DRAWS, seed: int = 0) -> list[Axis]:
        """Axes that the recording may have come from, with random parameters of a ``seed``."""
        from furuta.axis.draws import drawn_axes

        return drawn_axes(self, number, seed)

    def per_radian(self, controller: Controller) -> Controller:
        """The controller whose gains are given per recorded unit of the position."""
        return per_unit(controller, 1.0 / self.recorded_unit[1])

    def write(
        self,
        path: str | Path,
        controller: Controller | None = None,
        compensation: str | None = None,
        rule: IntegralRule = NO_RULE,
    ) -> None:
        """Write a joint file: parameters of a friction observer, and the controller.

        Args:
            path: The file.
            controller: The gains of the joint, if they are known.
            compensation: The one that suits them; by default ``recommended``.
            rule: That of the controller's integral.

        Raises:
            ParameterError: No friction was found.
        """
        from furuta.axis.joint_file import write_joint_file

        write_joint_file(path, {self.joint: self}, controller, compensation, rule)

    def kept(self) -> dict[str, Any]:
        """Everything as parameters of a ROS node: numbers, text and lists of them."""
        size = {"recorded_unit": self.recorded_unit[0], "recorded_size": self.recorded_unit[1]}
        return {
            **{name: getattr(self, name) for name in PLAIN},
            **size,
            **self.verdict._asdict(),
            "findings": self.findings,
            "found": list(self.values),
            "values": list(self.values.values()),
            "standard_errors": [self.standard_errors[name] for name in self.values],
            "units": [self.units[name] for name in self.values],
            "undetermined": list(self.undetermined),
            "undetermined_reasons": list(self.undetermined.values()),
            "names": list(self.names),
            "means": self.means.tolist(),
            "covariance": self.covariance.ravel().tolist(),
        }

    @classmethod
    def of_kept(cls, given: Mapping[str, Any], where: str) -> IdentifiedAxis:
        """What :meth:`kept` has given; raises ParameterError if it is something else."""
        try:
            p = len(given["names"])
            if given["usable"] not in GRADES:
                raise ValueError(f"usable is {given['usable']}")

            def by_name(name: str, names: str = "found", kind: type = float) -> dict[str, Any]:
                pairs = zip(given[names], given[name], strict=True)
                return {str(each): kind(value) for each, value in pairs}

            return cls(
                by_name("values"),
                by_name("standard_errors"),
                by_name("undetermined_reasons", "undetermined", str),
                by_name("units", kind=str),
                Verdict(given["usable"], [str(each) for each in given["reasons"]]),
                [str(each) for each in given["findings"]],
                tuple(map(str, given["names"])),
                np.reshape(np.array(given["covariance"], dtype=float), (p, p)),
                np.reshape(np.array(given["means"], dtype=float), p),
                str(given["joint"]),
                float(given["interval"]),
                str(given["position_unit"]),
                str(given["torque_unit"]),
                (str(given["recorded_unit"]), float(given["recorded_size"])),
                float(given["resolution"]),
                float(given["hidden"]),
            )
        except (KeyError, ValueError, TypeError) as error:
            reason = f"it has no {error}" if isinstance(error, KeyError) else str(error)
            raise ParameterError(f"{where} is no identified axis: {reason}") from None
