"""What recordings may be of, for :func:`furuta.identify`: each with what is known of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeVar

from furuta.identification.axis.fit import AxisFit
from furuta.identification.axis.identify import identify_axis
from furuta.identification.bodies.arm_joint import identify_arm_joint
from furuta.identification.bodies.servo import identify_servo
from furuta.identification.fitted import Fitted
from furuta.identification.fitting.free_swing import FreeSwing, identify_free_swing
from furuta.identification.fitting.friction_laws import compare_laws
from furuta.identification.identify import held_out, identify
from furuta.identification.options import ANGLE_UNITS, AUTO_DIRECTION, ZEROS, Options
from furuta.results.result import Result
from furuta.results.rig_models import RigModel, rig_model
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.readers.assembly import one_after_the_other
from furuta_recordings.recording import Recording, numbered

Report = Callable[[str], None]
Found_co = TypeVar("Found_co", bound=Result, covariant=True)


class Body(Protocol[Found_co]):
    """What :func:`furuta.identify` asks of a body, also of one of your own."""

    def identified(self, recordings: Sequence[Recording], report: Report) -> Found_co:
        """The fit to one or several recordings of it; ``report`` gets what is in work, in words.

        Raises :class:`furuta.ParameterError` where these do not determine one.
        """


@dataclass(frozen=True)
class PendulumBody:
    """A rotary pendulum; of one that swings freely only its own motion is found.

    Attributes:
        zero: Where the pendulum's angle is 0: upright, hanging, auto to detect it, or the measured
            angle of the hanging pendulum [rad].
        direction: Of the pendulum's angle: 1 if an upright pendulum falls in its negative direction
            when the arm accelerates in its positive one, −1 the other way, 0 to detect it.
        angles: Unit of the angles: rad, deg, or auto to detect it.
        command_scale: Voltage that a command of 1 stands for [V].
        ceiling: Highest voltage of the drive [V]; None detects it, if the data show it.
        window: Length [s] of the segments that are simulated; None chooses it.
        validate: Recordings to test the model on, which are not used for the fit.
        laws: Whether to compare laws of the arm's friction by how well they predict held-out
            recordings, or held-out halves of a single one.
    """

    zero: str | float = "auto"
    direction: float = AUTO_DIRECTION
    angles: str = "auto"
    command_scale: float = 1.0
    ceiling: float | None = None
    window: float | None = None
    validate: Sequence[Recording] = ()
    laws: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "validate", tuple(self.validate))
        _one_of("angles", self.angles, ANGLE_UNITS)
        if isinstance(self.zero, str):
            _one_of("zero", self.zero, ZEROS)

    def identified(self, recordings: Sequence[Recording], report: Report) -> RigModel | FreeSwing:
        """A model, also if its verdict is that it is not usable; or the pendulum's own motion."""
        options = Options(
            self.zero,
            self.window,
            self.angles,
            self.command_scale,
            self.direction,
            self.ceiling,
            report,
        )
        given, others = numbered(recordings), numbered(self.validate)
        if not any(len(recording.command) for recording in given):
            free = PendulumBody(angles=self.angles)
            if used := [name for name, value in vars(self).items() if value != vars(free)[name]]:
                raise ParameterError(f"free swings give no model: leave out {', '.join(used)}")
            return identify_free_swing(given, options)
        model = identify(given, options)
        laws = compare_laws(model, report) if self.laws else []
        return rig_model(model, held_out(model, others, options), laws)


@dataclass(frozen=True)
class AxisBody:
    """A servo axis that its torque alone moves; several recordings have their own offsets."""

    def identified(self, recordings: Sequence[Recording], report: Report) -> AxisFit:
        """Inertia, friction, and what else the recordings show."""
        return identify_axis(recordings, report)


@dataclass(frozen=True)
class ServoBody:
    """A servo with a position loop of its own, in units of that loop's stiffness.

    Attributes:
        goal: The goal, as the position of another recording of the same file
            (``read_axis(..., command="none")``). By default it is the command.
    """

    goal: Recording | None = None

    def identified(self, recordings: Sequence[Recording], report: Report) -> Fitted:
        """Friction, damping, inertia, delay and limit."""
        report("fitting the servo")
        own = one_after_the_other(recordings)
        if self.goal is not None:
            time = self.goal.time + (self.goal.start - own.start)
            own = own._replace(command_time=time, command=self.goal.measured[:, PHI])
        return identify_servo(own)


@dataclass(frozen=True)
class JointBody:
    """A joint of an arm of which other joints move too: its friction.

    Attributes:
        moving: Positions of the other joints that move (``read_axis(..., command="none")``).
        urdf: The arm's geometry, whose joints have the names of the recordings' joints. Masses in
            it are not used. All joints without a recording are taken to be fixed at 0.
    """

    moving: Sequence[Recording] = ()
    urdf: str | Path | None = None

    def identified(self, recordings: Sequence[Recording], report: Report) -> Fitted:
        """Friction, inertia and load of the joint."""
        report("fitting the torque of the joint")
        return identify_arm_joint(one_after_the_other(recordings), self.moving, self.urdf)


def _one_of(name: str, given: str, known: Sequence[str]) -> None:
    if given not in known:
        raise ParameterError(f"{name} must be one of {', '.join(known)}, given {given}")
