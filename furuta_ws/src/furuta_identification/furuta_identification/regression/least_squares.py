"""Linear least squares with standard errors for overlapping windows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Regression(NamedTuple):
    """Coefficients (k,), their standard errors (k,), and the unexplained part, 0 to 1."""

    coefficients: np.ndarray
    errors: np.ndarray
    misfit: float


def regress(x: np.ndarray, y: np.ndarray) -> Regression:
    """Fit y (n,) = x (n, k) · coefficients.

    Windows overlap by half, which doubles the variance. A coefficient whose column is zero stays
    zero, and its standard error is infinite.
    """
    scale = np.linalg.norm(x, axis=0)
    used = scale > 0.0
    coefficients, errors = np.zeros(len(scale)), np.full(len(scale), np.inf)
    x, scale = x[:, used] / scale[used], scale[used]
    solution, _, _, _ = np.linalg.lstsq(x, y, rcond=1e-6)
    residual = y - x @ solution
    variance = 2.0 * residual @ residual / max(1, len(y) - len(scale))
    coefficients[used] = solution / scale
    errors[used] = np.sqrt(variance * np.diag(np.linalg.pinv(x.T @ x, rcond=1e-12))) / scale
    size = float(np.linalg.norm(y))
    misfit = float(np.linalg.norm(residual)) / size if size else 1.0
    return Regression(coefficients, errors, misfit)
