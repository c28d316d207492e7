"""First values of an axis by regression on smoothed positions."""

from collections.abc import Iterator, Sequence

import numpy as np

from furuta.identification.axis.segments import Smoothed, smoothed
from furuta.identification.bodies.axis import NOTHING
from furuta.identification.unknowns import Values
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

# Delays [s] that are tried; a torque that is measured is recorded after it acted. Part of the
# largest speed above which the axis surely slides.
EARLIEST = -0.06
DELAYS = np.arange(EARLIEST, 0.0301, 0.002)
SLIDES = 0.05
# Smoothing times that are tried, relative to the one for the first states.
WINDOWS = (1.0, 4.0)


def first_values(
    recordings: Sequence[Recording], even: Sequence[Smoothed], gravity: bool
) -> Iterator[Values]:
    """First values, one for each smoothing time in which the torque accelerates the axis.

    ``even`` are the recordings, smoothed for the first states.

    Raises:
        ParameterError: There is none.
    """
    found = False
    for factor in WINDOWS:
        pairs = zip(recordings, even, strict=True)
        values = _regression([smoothed(r, factor * each.window) for r, each in pairs], gravity)
        if values["inertia"] > 0.0:
            found = True
            yield values
    if not found:
        raise ParameterError(
            f"{recordings[0].name}: the torque does not accelerate the axis; change its sign, or "
            "record a motion that accelerates, with one joint alone moving"
        )


def _regression(parts: list[Smoothed], gravity: bool) -> Values:
    """The values of the delay that explains the torque best."""
    fits = [(*_at_delay(parts, gravity, delay), delay) for delay in DELAYS]
    _, values, delay = min(fits, key=lambda each: each[0])
    inertia, level, viscous, spring, sine, cosine = map(float, values[:6])
    return {
        **NOTHING,
        "inertia": inertia,
        "alpha0": max(level, 1e-3 * _size(parts)),
        "viscous": max(viscous, 0.0),
        "delay": float(delay),
        "spring": spring,
        "gravity_sin": sine,
        "gravity_cos": cosine,
        **{("offset", number): float(value) for number, value in enumerate(values[6:])},
    }


def _size(parts: list[Smoothed]) -> float:
    """Root mean square of the torque."""
    return float(np.sqrt(np.mean(np.concatenate([part.torque for part in parts]) ** 2)))


def _at_delay(parts: list[Smoothed], gravity: bool, delay: float) -> tuple[float, np.ndarray]:
    """Sum of squares and coefficients of the torque, where the axis slides."""
    rows, torques = [], []
    fastest = max(float(np.max(np.abs(part.speed))) for part in parts)
    for number, part in enumerate(parts):
        late = np.interp(part.time - delay, part.time, part.torque)
        slides = np.abs(part.speed) > SLIDES * fastest
        q, ones = part.position, np.zeros((len(part.time), len(parts)))
        ones[:, number] = 1.0
        rows.append(
            np.column_stack(
                [
                    part.acceleration,
                    np.sign(part.speed),
                    part.speed,
                    q,
                    *((np.sin(q), np.cos(q)) if gravity else (0.0 * q, 0.0 * q)),
                    ones,
                ]
            )[slides]
        )
        torques.append(late[slides])
    matrix, torque = np.concatenate(rows), np.concatenate(torques)
    values, *_ = np.linalg.lstsq(matrix, torque, rcond=1e-6)
    return float(np.sum((torque - matrix @ values) ** 2)), values
