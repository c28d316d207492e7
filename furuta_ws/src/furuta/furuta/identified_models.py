"""Models from recordings: of rigs, of servo axes, of the joints of an arm, and of servos."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from furuta.identification import identify as rigs
from furuta.identification.axis import identify as axes
from furuta.identification.bodies import arm_joint, servo
from furuta.identification.fitting.free_swing import identify_free_swing
from furuta.identification.fitting.friction_laws import compare_laws
from furuta.identification.options import ANGLE_UNITS, AUTO_DIRECTION, ZEROS, Options, silent
from furuta.identification.result import identified_rig as rig_files
from furuta.results.identified import AxisFit, AxisFits, JointFit
from furuta.results.rig_models import FreeSwing, RigModel
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI
from furuta_recordings.recording import Recording, numbered
from furuta_ros.errors import UserError

Recordings = Recording | Sequence[Recording]


def identify(
    recordings: Recording | Iterable[Recording],
    *,
    zero: str | float = "auto",
    direction: float = AUTO_DIRECTION,
    angles: str = "auto",
    command_scale: float = 1.0,
    ceiling: float | None = None,
    window: float | None = None,
    validate: Iterable[Recording] = (),
    laws: bool = False,
    report: Callable[[str], None] = silent,
) -> RigModel | FreeSwing:
    """Fit one model of pendulum and friction to recordings of a rig.

    Args:
        recordings: One recording, or several of the same rig. Of a pendulum that swings freely
            (``read_recording(path, command="none")``) only its own motion is found.
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
        report: Gets what is in work, in words.

    Returns:
        The model, also if its verdict is that it is not usable; or the pendulum's own motion.

    Raises:
        ParameterError: The recordings do not determine a model, or an argument is not allowed.
    """
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ParameterError("recordings must be at least one recording, given none")
    _one_of("angles", angles, ANGLE_UNITS)
    if isinstance(zero, str):
        _one_of("zero", zero, ZEROS)
    options = Options(zero, window, angles, command_scale, direction, ceiling, report)
    given, others = numbered(given), numbered(list(validate))
    if not any(len(recording.command) for recording in given):
        of_model = {
            "zero": zero != "auto",
            "direction": direction != AUTO_DIRECTION,
            "command_scale": command_scale != 1.0,
            **{"ceiling": ceiling is not None, "window": window is not None},
            **{"validate": bool(others), "laws": laws},
        }
        if used := [name for name, is_given in of_model.items() if is_given]:
            raise ParameterError(f"free swings give no model: leave out {', '.join(used)}")
        return FreeSwing(identify_free_swing(given, options))
    model = rigs.identify(given, options)
    held_out = rigs.held_out(model, others, options)
    return RigModel(model, held_out, compare_laws(model, report) if laws else ())


def _one_of(name: str, given: str, known: Iterable[str]) -> None:
    if given not in known:
        raise ParameterError(f"{name} must be one of {', '.join(known)}, given {given}")


def identified_rig(
    model: RigModel, base: Rig | None = None, source: str | Path | None = None
) -> Rig:
    """A rig with an identified model, and with the sensors, line and limits of another one.

    Args:
        model: What :func:`identify` returned.
        base: The rig that has the sensors, the line and the limits; by default as ``source`` has
            it, or the paper's.
        source: The bag of the first recording, which may tell them.

    Raises:
        ParameterError: The model is not usable.
    """
    model.verdict.require()
    known, _ = rig_files.base_rig(model.found, base, source)
    return rig_files.identified_rig(model.found, known)[0]


def identify_axis(recordings: Recordings, *, report: Callable[[str], None] = silent) -> AxisFit:
    """Fit an axis to recordings of its position and of the torque of its drive.

    Args:
        recordings: What :func:`furuta.read_axis` returned; several of the same axis have their own
            offsets.
        report: Gets what is in work, in words.

    Raises:
        ParameterError: The axis hardly moves, or the recording does not determine its inertia.
    """
    return AxisFit(axes.identify_axis(recordings, report))


def identify_axes(
    recordings: Mapping[str, Recordings], *, report: Callable[[str], None] = silent
) -> AxisFits:
    """Fit several axes, such as the joints of a robot, each on its own.

    Args:
        recordings: As of :func:`identify_axis`, by joint. What is wrong with one of them is said in
            the result.
        report: Gets what is in work, in words.
    """
    fits, refused = {}, {}
    for joint, own in recordings.items():
        try:
            report(f"identifying {joint}")
            fits[joint] = identify_axis(own)
        except (ParameterError, UserError) as error:
            refused[joint] = str(error)
    return AxisFits(fits, refused)


def identify_arm_joint(
    recording: Recording, others: Sequence[Recording] = (), urdf: str | Path | None = None
) -> JointFit:
    """Fit the friction of one joint of an arm of which other joints move too.

    Args:
        recording: Position and torque of the joint, as :func:`furuta.read_axis` returns them.
        others: Positions of the other joints that move (``read_axis(..., command="none")``).
        urdf: The arm's geometry, whose joints have the names of the recordings' joints. Masses in
            it are not used. All joints without a recording are taken to be fixed at 0.

    Raises:
        ParameterError: The joint hardly moves, a name is not in the URDF, or too little is
            recorded.
    """
    found = arm_joint.identify_arm_joint(recording, others, urdf)
    return JointFit(found, left_over=found.part)


def identify_servo(recording: Recording, goal: Recording | None = None) -> JointFit:
    """Fit a servo with a position loop of its own, in units of that loop's stiffness.

    Args:
        recording: Its position, as :func:`furuta.read_axis` returns it.
        goal: The goal, as the position of another recording of the same file
            (``read_axis(..., command="none")``). By default it is the command of ``recording``.

    Raises:
        ParameterError: The servo does not follow its goal.
    """
    if goal is not None:
        recording = recording._replace(
            command_time=goal.time + (goal.start - recording.start), command=goal.measured[:, PHI]
        )
    found = servo.identify_servo(recording)
    return JointFit(found, left_over=found.left)
