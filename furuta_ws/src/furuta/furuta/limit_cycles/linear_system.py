"""Reads A, b and c of a linear loop from a state space model, a transfer function or matrices.

The objects of python-control and of scipy.signal are known by their attributes, so that neither
library is needed.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from furuta_model.arguments import check
from furuta_model.parameters import ParameterError

Matrices = tuple[np.ndarray, np.ndarray, np.ndarray]


def matrices(system: Any) -> Matrices:
    """A (n, n), b (n,) and c (n,) of ẋ = A x + b f, v = c x with force f and speed v of the joint.

    Raises:
        ParameterError: It is none of these, is sampled, or has more than one input or output, or
            the force acts on the speed without delay.
    """
    if isinstance(system, tuple | list) and len(system) == 3:
        parts = zip("Abc", system, strict=True)
        a, b, c = (np.atleast_1d(check(name, part, float | np.ndarray)) for name, part in parts)
        return np.atleast_2d(a), b.ravel(), c.ravel()
    if getattr(system, "dt", None):
        raise ParameterError(f"the loop must be in continuous time, given dt = {system.dt}")
    if hasattr(system, "num") and hasattr(system, "den"):
        from scipy.signal import tf2ss

        a, b, c, d = tf2ss(_coefficients(system.num), _coefficients(system.den))
    elif all(hasattr(system, name) for name in "ABCD"):
        a, b, c, d = (np.asarray(getattr(system, name), dtype=float) for name in "ABCD")
    else:
        raise ParameterError(
            "a linear loop is a state space model with A, B, C and D, a transfer function with num "
            f"and den, or matrices (A, b, c), given {type(system).__name__}"
        )
    if b.shape[1] != 1 or c.shape[0] != 1:
        raise ParameterError(
            "a friction joint has one force and one speed, given "
            f"{b.shape[1]} inputs and {c.shape[0]} outputs"
        )
    if np.any(d):
        raise ParameterError(f"a force must not act on the speed without delay, given D = {d}")
    return a, b[:, 0], c[0]


def _coefficients(rows: Any) -> np.ndarray:
    """The coefficients of a polynomial, which python-control keeps by output and input."""
    while np.ndim(rows[0]):
        if len(rows) != 1:
            raise ParameterError(f"a friction joint has one force and speed, given {len(rows)}")
        rows = rows[0]
    return np.asarray(rows, dtype=float)
