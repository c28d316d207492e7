"""Models of rigs from recordings, as the library gives them."""

from collections.abc import Iterable
from typing import Any

from furuta.identification.identify import identify as fit
from furuta.identification.model import Model
from furuta.identification.options import Options
from furuta.identification.result.report import summary
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording


def identify(
    recordings: Recording | Iterable[Recording],
    *,
    zero: str = "auto",
    angles: str = "auto",
    window: float | None = None,
    command_scale: float = 1.0,
) -> Model:
    """Fit one model of pendulum and friction to recordings of a rig.

    Args:
        recordings: One recording, or several of the same rig.
        zero: Where the pendulum's angle is 0: upright, hanging, or auto to detect it.
        angles: Unit of the angles: rad, deg, or auto to detect it.
        window: Length [s] of the segments that are simulated; None chooses it.
        command_scale: Voltage that a command of 1 stands for [V].

    Returns:
        The model; :func:`identified_values` lists its values with standard errors.

    Raises:
        ParameterError: The recordings do not determine a model.
    """
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ParameterError("recordings must be at least one recording, given none")
    return fit(given, Options(zero, window, angles, command_scale))


def identified_values(model: Model) -> dict[str, Any]:
    """Values and standard errors of an identified model, as ``furuta identify --json`` prints them.

    Args:
        model: What :func:`identify` returned.

    Returns:
        α, β, γ [V s²/rad], δ [V/rad], friction [V, V s/rad] and ``standard_errors`` by name; None
        where the data do not determine a value, with the reason in ``undetermined``.
    """
    return summary(model)
