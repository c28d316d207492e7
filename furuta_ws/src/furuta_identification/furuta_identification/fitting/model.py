"""The result of a fit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.momentum import MomentumFit
from furuta_identification.shooting.parameter_values import ParameterValues
from furuta_recordings.recording import Recording


class Model(NamedTuple):
    """A fitted model.

    ``names`` are the fitted unknowns, then those that had to be assumed; ``covariance`` is that of
    their vector, ``information`` the data's part of its inverse. ``window`` [s] is infinite for
    free runs, ``scale`` (4,) the residual of each channel that counts as one, ``regression`` the
    first estimate.

    ``command_negated`` is True if a positive command turns the arm in its negative direction.
    ``angles`` is the unit of the recorded angles, ``direction`` that of the pendulum's angle.
    ``command_delay`` [s] was applied to the recordings' commands before the rest of the delay was
    fitted.
    """

    values: ParameterValues
    names: list[str]
    covariance: np.ndarray
    information: np.ndarray
    window: float
    scale: np.ndarray
    regression: MomentumFit
    recordings: list[Recording]
    findings: list[str]
    command_negated: bool = False
    command_delay: float = 0.0
    angles: str = "rad"
    direction: float = 1.0

    @property
    def fitted(self) -> list[str]:
        """Names of the unknowns that were fitted, without those that had to be assumed."""
        return [name for name, row in zip(self.names, self.information, strict=True) if row.any()]

    @property
    def largest_command(self) -> float:
        """The largest command of the fitted recordings [V]."""
        return max(float(np.max(np.abs(each.command))) for each in self.recordings)
