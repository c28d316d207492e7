"""Covariance from differences between recordings that their own errors do not explain."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.coulomb import turns_one_way
from furuta_identification.fitting.optimisation import Optimum
from furuta_identification.shooting.unknowns import is_zero
from furuta_identification.uncertainty.covariance import covariance_and_information


def difference_covariance(
    common: Optimum, own_fits: list[Optimum], assumed: dict[str, float]
) -> np.ndarray:
    """Covariance of the differences between the recordings' own fits and the common one.

    What exceeds a recording's own errors is a difference between recordings that the model does
    not describe: random effects as in DerSimonian and Laird (1986).
    """
    names = [*common.shooting.names, *assumed]
    covariance = np.zeros((len(names), len(names)))
    if len(own_fits) == 1:
        return covariance
    for fit in own_fits:
        excess = _excess(common, fit, names, assumed)
        covariance += np.outer(excess, excess) / len(own_fits)
    return covariance


def _excess(
    common: Optimum, fit: Optimum, names: list[str], assumed: dict[str, float]
) -> np.ndarray:
    """The difference of each unknown beyond the standard error of the recording's own fit."""
    one_way = all(turns_one_way(part.recording) for part in fit.shooting.parts)
    own, _ = covariance_and_information(fit.shooting, fit.vector, assumed, swinging=True)
    excess = np.zeros(len(names))
    for k, (name, value) in enumerate(zip(fit.shooting.names, fit.vector, strict=True)):
        if is_zero(name) or (one_way and name in ("coulomb", "asymmetry")):
            continue
        difference = value - common.values.coordinates[name]
        size = np.sqrt(max(0.0, difference**2 - own[k, k]))
        excess[names.index(name)] = np.sign(difference) * size
    return excess
