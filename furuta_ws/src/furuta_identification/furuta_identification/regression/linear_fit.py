"""Linear least squares over windows, with standard errors."""

from typing import NamedTuple

import numpy as np

from furuta_identification.regression.autocorrelation import correlation_length

# Size of a column, relative to the largest, that rounding can have: that of an arm at rest.
ROUNDING = 1e-9
# Windows overlap by half, so at most every other one counts.
OVERLAP = 2.0


class LinearFit(NamedTuple):
    """Coefficients (k,), their standard errors (k,), and the unexplained part, 0 to 1.

    ``samples`` is the effective number of windows.
    """

    coefficients: np.ndarray
    errors: np.ndarray
    misfit: float
    samples: float


def regress(x: np.ndarray, y: np.ndarray) -> LinearFit:
    """Fit y (n,) = x (n, k) · coefficients.

    A coefficient whose column is zero stays zero, and its standard error is infinite.
    """
    scale = np.linalg.norm(x, axis=0)
    used = scale > ROUNDING * np.max(scale)
    coefficients, errors = np.zeros(len(scale)), np.full(len(scale), np.inf)
    x, scale = x[:, used] / scale[used], scale[used]
    solution = np.linalg.lstsq(x, y, rcond=ROUNDING)[0]
    residual = y - x @ solution
    correlated = max(OVERLAP, correlation_length(residual))
    variance = correlated * float(residual @ residual) / len(y)
    coefficients[used] = solution / scale
    variances = variance * np.diag(np.linalg.pinv(x.T @ x, rcond=1e-12))
    errors[used] = np.sqrt(np.maximum(variances, 0.0)) / scale
    size = float(np.linalg.norm(y))
    misfit = float(np.linalg.norm(residual)) / size if size else 1.0
    return LinearFit(coefficients, errors, misfit, len(y) / correlated)
