"""The highest voltage that the drive reaches, from motions under larger commands."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from furuta_identification.fitting.model import Model
from furuta_identification.regression.equations import ceiling_misfits
from furuta_identification.regression.speeds import with_speeds
from furuta_identification.regression.whiteness import correlation_length
from furuta_identification.shooting.segments import cut_into_segments
from furuta_identification.shooting.shooting import Shooting
from furuta_model.state import PHI_DOT, RIGID_STATES
from furuta_recordings.recording import Recording

# Ceilings that are tried, as parts of the largest command.
PARTS = np.linspace(0.3, 0.98, 35)
# Logarithm of the likelihood ratio from which a ceiling is there.
SURE = 10.0
# A model whose scale is slightly wrong also fits better with a ceiling just below the command. So
# in a held-out recording a ceiling counts only this far below it and if residuals shrink by this.
CLEARLY_LOWER, SMALLEST_RATIO = 0.95, 1.5
# Part by which a command must exceed those of the fit before it may meet an unknown ceiling.
FARTHER = 1.02
# Part of the largest command within which all others are of the same level.
SAME_LEVEL = 0.05


def fitted_ceiling(recordings: list[Recording], lag: float, delay: float) -> float:
    """A first value of the ceiling [V], infinite where the arm's equation shows none."""
    ready = [with_speeds(each.with_delayed_command(delay), lag) for each in recordings]
    largest = max(float(np.max(np.abs(each.command))) for each in ready)
    misfits, samples = ceiling_misfits(ready, [*(PARTS * largest), np.inf])
    best = int(np.argmin(misfits))
    if samples * np.log(misfits[-1] / misfits[best]) < SURE:
        return float(np.inf)
    return float(PARTS[best] * largest)


def has_one_level(recordings: list[Recording]) -> bool:
    """Whether all commands are of one size, such as a step: then no ceiling can be found.

    A drive that reaches a part of the command only and a rig whose inertias and friction are larger
    in proportion give the same motion.
    """
    sizes = np.abs(np.concatenate([each.command for each in recordings]))
    largest = float(np.max(sizes))
    return bool(np.all((sizes == 0.0) | (sizes > (1.0 - SAME_LEVEL) * largest)))


def what_hides_a_ceiling(recordings: list[Recording]) -> list[str]:
    """A finding if no ceiling could be found in these recordings."""
    if not has_one_level(recordings):
        return []
    return [
        "the command has one level only, so a drive that reaches less cannot be noticed: all "
        "values in volts would be too large in proportion (state its limit with --ceiling)"
    ]


def ceiling_of(model: Model, recording: Recording) -> float:
    """The ceiling [V] of a recording with larger commands than those of the fit; else infinite.

    It is the only value that is fitted to this recording.
    """
    largest = float(np.max(np.abs(recording.command)))
    if np.isfinite(model.values["ceiling"]) or largest < FARTHER * model.largest_command:
        return model.values["ceiling"]
    residuals = _residuals_by_ceiling(model, recording)
    candidates = [part * largest for part in PARTS if part * largest >= model.largest_command]
    if not candidates:
        return float(np.inf)
    best = min(candidates, key=lambda ceiling: _size(residuals(ceiling)))
    reach = (PARTS[1] - PARTS[0]) * largest
    found = minimize_scalar(
        lambda ceiling: _size(residuals(ceiling)), bounds=(best - reach, best + reach)
    ).x
    after = residuals(found)
    samples = len(after) / correlation_length(after[:, PHI_DOT])
    ratio = _size(residuals(np.inf)) / _size(after)
    sure = samples * np.log(ratio) > SURE and ratio > SMALLEST_RATIO
    return float(found) if sure and found < CLEARLY_LOWER * largest else float(np.inf)


def _residuals_by_ceiling(model: Model, recording: Recording) -> Callable[[float], np.ndarray]:
    """Weighted residuals (n, 4) of a free run as a function of the ceiling [V]."""

    def residuals(ceiling: float) -> np.ndarray:
        values = model.values.changed(["ceiling"], [np.log(ceiling)])
        part = cut_into_segments(recording, model.window, model.scale, values)
        found = Shooting([part], [], values).residuals(np.zeros(0))
        return found[: RIGID_STATES * len(recording.time)].reshape(-1, RIGID_STATES)

    return residuals


def _size(residuals: np.ndarray) -> float:
    return float(np.linalg.norm(residuals))
