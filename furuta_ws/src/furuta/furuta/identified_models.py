"""Models from recordings of a pendulum, an axis, a servo, or a joint of an arm."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar, overload

from furuta.bodies import AxisBody, Body, JointBody, PendulumBody, ServoBody
from furuta.identification.axis.fit import AxisFit
from furuta.identification.fitted import Fitted
from furuta.identification.fitting.free_swing import FreeSwing
from furuta.identification.options import silent
from furuta.identification.result import identified_rig as rig_files
from furuta.results.identified import Fits
from furuta.results.result import Result
from furuta.results.rig_models import RigModel
from furuta_hw.rigs.rig import Rig
from furuta_model.parameters import ParameterError, shortened
from furuta_recordings.recording import Recording
from furuta_ros.errors import UserError

Recordings = Recording | Iterable[Recording]
Found = TypeVar("Found", bound=Result)
# Bodies by their names.
BODIES: dict[str, type[Body[Result]]] = {
    "pendulum": PendulumBody,
    "axis": AxisBody,
    "servo": ServoBody,
    "joint": JointBody,
}


@overload
def identify(
    recordings: Recordings,
    body: Literal["pendulum"] | PendulumBody = "pendulum",
    *,
    report: Callable[[str], None] = silent,
) -> RigModel | FreeSwing: ...
@overload
def identify(
    recordings: Recordings,
    body: Literal["axis"] | AxisBody,
    *,
    report: Callable[[str], None] = silent,
) -> AxisFit: ...
@overload
def identify(
    recordings: Recordings,
    body: Literal["servo", "joint"] | ServoBody | JointBody,
    *,
    report: Callable[[str], None] = silent,
) -> Fitted: ...
@overload
def identify(
    recordings: Mapping[str, Recordings],
    body: Literal["axis", "servo"] | AxisBody | ServoBody,
    *,
    report: Callable[[str], None] = silent,
) -> Fits: ...
@overload
def identify(
    recordings: Recordings, body: Body[Found], *, report: Callable[[str], None] = silent
) -> Found: ...


def identify(
    recordings: Recordings | Mapping[str, Recordings],
    body: Any = "pendulum",
    *,
    report: Callable[[str], None] = silent,
) -> Result:
    """Fit a body to recordings of it.

    Args:
        recordings: One recording, or several of the same body, as :func:`furuta.read_recording`
            returns them of a pendulum, and :func:`furuta.read_axis` of everything else. A mapping
            has those of several axes or servos by joint; each is fitted on its own.
        body: pendulum, axis (which its torque alone moves), servo (with a position loop of its own,
            of which goal and position are known) or joint (of an arm that moves); or one of
            :class:`furuta.PendulumBody`, :class:`furuta.AxisBody`, :class:`furuta.ServoBody` and
            :class:`furuta.JointBody` with what is known of it; or a body of your own, with a method
            ``identified(recordings, report)``.
        report: Gets what is in work, in words.

    Returns:
        The fit, also if its verdict is that it is not usable. Each has ``values``,
        ``standard_errors``, ``undetermined``, ``units``, ``verdict`` and ``conf_int()``; a model of
        a motion also ``covariance``, ``residual`` and ``predict(recording)``.

    Raises:
        ParameterError: The recordings do not determine a model, or an argument is not allowed.
    """
    chosen = _body(body)
    if not isinstance(recordings, Mapping):
        given = [recordings] if isinstance(recordings, Recording) else list(recordings)
        if not given:
            raise ParameterError("recordings must be at least one recording, given none")
        return chosen.identified(given, report)
    fits: dict[str, Fitted] = {}
    refused = {}
    for joint, own in recordings.items():
        try:
            report(f"identifying {joint}")
            fit = identify(own, chosen)
        except (ParameterError, UserError) as error:
            refused[joint] = str(error)
            continue
        if not isinstance(fit, Fitted):
            raise ParameterError("several joints by name are axes or servos")
        fits[joint] = fit
    return Fits(fits, refused)


def _body(body: Any) -> Body[Result]:
    """A body by its name, or itself."""
    if isinstance(body, str) and body in BODIES:
        return BODIES[body]()
    if isinstance(body, type) or not callable(getattr(body, "identified", None)):
        known = ", ".join(BODIES)
        raise ParameterError(
            f"body must be one of {known}, or an object with a method identified, given "
            f"{shortened(body)}"
        )
    return body  # type: ignore[no-any-return]


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
    known, _ = rig_files.base_rig(model.model, base, source)
    return rig_files.identified_rig(model.model, known)[0]
