"""What recordings tell of axes, joints and servos: values with errors, and a verdict on them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from textwrap import fill
from typing import Any

from furuta.axis.axis import NO_RULE, Axis, Controller, IntegralRule
from furuta.axis.draws import DRAWS, drawn_axes, identified_axis
from furuta.axis.gains import per_unit
from furuta.axis.joint_file import write_joint_file
from furuta.identification.axis import identify
from furuta.identification.axis.friction_curve import axis_followed, axis_friction
from furuta.identification.verdict import NO, YES, Identified, Verdict
from furuta.results.result import Found, Result
from furuta.results.text import WIDTH, table_text, values_text
from furuta_model.parameters import ParameterError

# What a row says of one of several joints.
OF_JOINT = ("inertia", "alpha0", "alpha1", "viscous", "gravity_sin", "gravity_cos")


def verdict_sentence(verdict: Verdict, what: str = "values") -> str:
    """Whether something is usable, and why not."""
    if verdict.usable == YES:
        return f"The {what} {'are' if what.endswith('s') else 'is'} usable."
    grade = "not usable" if verdict.usable == NO else verdict.usable
    verb = "are" if what.endswith("s") else "is"
    return f"The {what} {verb} {grade}: {'; '.join(verdict.reasons)}."


def findings_text(findings: Iterable[str]) -> str:
    """How recordings were interpreted, a paragraph each."""
    return "\n".join(fill(f"- {each}", WIDTH, subsequent_indent="  ") for each in findings)


class JointFit(Found):
    """What a recording tells of a joint of a moving arm, or of a servo with a loop of its own.

    Fields: ``values`` and ``standard_errors`` by name, ``undetermined`` with the reasons,
    ``usable`` (yes, doubtful, no) with ``reasons``, ``findings``; ``unit(name)`` of a value.
    """

    found: Identified
    details = frozenset({"covariance", "usable", "reasons"})

    def __init__(self, found: Identified, **more: Any) -> None:
        super().__init__(found)
        self._more = more

    def _by_name(self) -> dict[str, Any]:
        """Values, ``standard_errors`` and ``units`` by name, the verdict, and what was found."""
        fit = self.found
        covered = getattr(fit, "covariance", None)
        names = {"names": list(getattr(fit, "names", ())), "values": covered}
        return {
            **fit.values,
            "standard_errors": fit.standard_errors,
            "undetermined": fit.undetermined,
            "units": {name: fit.unit(name) for name in fit.values},
            **fit.verdict._asdict(),
            **({} if covered is None else {"covariance": names}),
            **self._more,
            "findings": fit.findings,
        }

    def sentence(self) -> str:
        """Whether the values are usable."""
        return verdict_sentence(self.found.verdict)

    def table(self, values: Mapping[str, Any]) -> str:
        """The values with their errors, then how the recordings were interpreted."""
        own = {name: each for name, each in values.items() if name != "findings"}
        return f"{values_text(own)}\n\n{findings_text(values['findings'])}"

    @property
    def is_usable(self) -> bool:
        """Whether the verdict is better than no."""
        return self.found.verdict.usable != NO

    def write(self, path: str | Path) -> None:
        """Raise, for only what the torque alone moves has a joint file."""
        raise ParameterError("only an axis that was identified alone has a joint file")

    def require(self, force: bool = False) -> None:
        """Raise :class:`furuta.ParameterError` if it is not usable, unless it is forced."""
        if not force:
            self.found.verdict.require("; --force uses it all the same")


class AxisFit(JointFit):
    """What recordings tell of an axis: fields as of :class:`JointFit`.

    Also ``names`` and ``covariance`` of all fitted unknowns, ``resolution`` of the position,
    ``hidden`` stiction that would not show, ``recordings``, and ``error(recording)`` of the free
    run over another recording.
    """

    found: identify.AxisFit

    def _by_name(self) -> dict[str, Any]:
        """As of :class:`JointFit`, with the ``resolution`` and the ``error`` of the free run."""
        values = super()._by_name()
        findings = values.pop("findings")
        about = {"resolution": self.found.resolution, "error": self.found.own_error}
        values["units"] |= dict.fromkeys(about, self.position_unit)
        return {**values, **about, "findings": findings}

    @property
    def position_unit(self) -> str:
        """The unit of the position: rad or m."""
        return self.found.recordings[0].units[0]

    @property
    def recorded_unit(self) -> tuple[str, float]:
        """The unit of the position in the recording, such as mm, and its size [rad or m]."""
        return self.found.recordings[0].position_unit

    def per_radian(self, controller: Controller) -> Controller:
        """The controller whose gains are given per recorded unit of the position."""
        return per_unit(controller, 1.0 / self.recorded_unit[1])

    def axis(self, law: str | None = None) -> Axis:
        """The axis, without what belongs to the recording: offset and drift.

        Args:
            law: coulomb, stiction or stribeck. None takes stribeck, or stiction if the recording
                shows that friction falls at once.

        Raises:
            ParameterError: The law has a bristle, which the recording does not show.
        """
        return identified_axis(self.found, law)

    def draws(self, number: int = DRAWS, seed: int = 0) -> list[Axis]:
        """Axes that the recording may have come from, with random parameters of a ``seed``."""
        return drawn_axes(self.found, number, seed)

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
        joint = self.found.recordings[0].joint
        write_joint_file(path, {joint: self.found}, controller, compensation, rule)

    def plot(self, axes: Any = None) -> Any:
        """Draw friction over speed, position and residual; see :meth:`Result.plot`."""
        from furuta.figures.friction import draw_friction

        return draw_friction(axis_friction(self.found), axis_followed(self.found), axes)


class AxisFits(Result):
    """Axes that were identified each on its own.

    Attributes:
        fits: What was found, by joint.
        refused: Why nothing was found, by joint.
    """

    def __init__(self, fits: Mapping[str, AxisFit], refused: Mapping[str, str]) -> None:
        self.fits, self.refused = dict(fits), dict(refused)

    def _by_name(self) -> dict[str, Any]:
        """The ``joints``, with what was found of each."""
        refused = {
            joint: {"usable": NO, "reasons": [reason]} for joint, reason in self.refused.items()
        }
        return {"joints": {joint: fit._by_name() for joint, fit in self.fits.items()} | refused}

    def sentence(self) -> str:
        """How many of the joints are usable."""
        usable = sum(fit.found.usable != NO for fit in self.fits.values())
        return f"{usable} of {len(self.fits) + len(self.refused)} joints are usable."

    def table(self, values: Mapping[str, Any]) -> str:
        """A row for each joint, then what speaks against it."""
        rows, doubts = [], dict(self.refused)
        for joint, fit in self.fits.items():
            known = {n: fit.found.values[n] for n in OF_JOINT if n in fit.found.values}
            titled = {f"{n.replace('_', ' ')} [{fit.found.unit(n)}]": v for n, v in known.items()}
            rows.append({"joint": joint, "usable": fit.found.usable, **titled})
            if fit.found.reasons:
                doubts[joint] = "; ".join(fit.found.reasons)
        return "\n\n".join(filter(None, (table_text(rows) if rows else "", values_text(doubts))))

    def require(self, force: bool = False) -> None:
        """Raise :class:`furuta.ParameterError` if a joint is not usable."""
        refused = [f"{joint}: {reason}" for joint, reason in self.refused.items()]
        refused += [
            f"{joint}: not usable: {'; '.join(fit.found.reasons)}; --force uses it all the same"
            for joint, fit in self.fits.items()
            if fit.found.usable == NO and not force
        ]
        Verdict(NO if refused else YES, refused).require()

    def write(self, path: str | Path) -> None:
        """Write a joint file with all joints.

        Raises:
            ParameterError: Of a joint no friction was found, or two names are one for ROS.
        """
        write_joint_file(path, {joint: fit.found for joint, fit in self.fits.items()})

    def plot(self, axes: Any = None) -> Any:
        """Draw the friction of each joint over its speed; see :meth:`Result.plot`."""
        from furuta.figures.friction import draw_joints

        if not self.fits:
            raise ParameterError(f"there is nothing to draw. {self.sentence()}")
        curves = {joint: axis_friction(fit.found) for joint, fit in self.fits.items()}
        return draw_joints(curves, axes)
