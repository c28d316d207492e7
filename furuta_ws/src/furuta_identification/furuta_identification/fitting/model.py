"""What a fit found."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.momentum import MomentumFit
from furuta_identification.shooting.unknowns import Guess
from furuta_recordings.recording import Recording


class Model(NamedTuple):
    """A fitted model.

    ``names`` the unknowns fitted, ``covariance`` of their vector, ``information`` the data's own
    part of its inverse; ``window`` [s] infinite for free runs; ``regression`` the first step;
    ``command_negated`` whether a positive command turns the arm in its negative direction,
    ``shift`` [s] by which the recordings' commands were moved before the rest of their delay was
    fitted.
    """

    guess: Guess
    names: list[str]
    covariance: np.ndarray
    information: np.ndarray
    window: float
    scale: np.ndarray
    regression: MomentumFit
    recordings: list[Recording]
    findings: list[str]
    command_negated: bool = False
    shift: float = 0.0
