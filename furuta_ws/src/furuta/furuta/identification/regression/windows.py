"""Linear regression on integrals over short windows, which need no derivative of noisy data."""

from typing import NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError

# Length of a window [s]: long compared with noise, short compared with the unstable pole.
WINDOW = 0.2
FEWEST_WINDOWS = 12
# Size of a column, relative to the largest, that rounding can have: that of an arm at rest.
ROUNDING = 1e-9
# Windows overlap by half, so at most every other one counts.
OVERLAP = 2.0
# Lags [samples] of the autocorrelations that are counted.
LAGS = 25
# Half width of the band that holds 95 % of the autocorrelations of white noise, times √n.
BAND = 1.96


class Windows:
    """Integrals weighted by bumps ψ = (1 − s²)³, s from −1 to 1, that overlap by half."""

    def __init__(self, time: np.ndarray, length: float = WINDOW) -> None:
        half = 0.5 * length
        centres = np.arange(time[0] + half, time[-1] - half, half)
        if len(centres) < FEWEST_WINDOWS:
            raise ParameterError(
                f"the recording is too short: {time[-1] - time[0]:.2f} s with data, at least "
                f"{(FEWEST_WINDOWS + 2) * half:.1f} s needed"
            )
        weights = np.gradient(time)
        self._rows = []
        for centre in centres:
            a, b = np.searchsorted(time, (centre - half, centre + half))
            if a == b:
                continue
            s = (time[a:b] - centre) / half
            bump = weights[a:b] * (1.0 - s * s) ** 3
            bump_slope = weights[a:b] * -6.0 * s * (1.0 - s * s) ** 2 / half
            self._rows.append((slice(a, b), bump, bump_slope))

    def mean(self, series: np.ndarray) -> np.ndarray:
        """∫ψy of each window."""
        return np.array([bump @ series[rows] for rows, bump, _ in self._rows])

    def slope(self, series: np.ndarray) -> np.ndarray:
        """∫ψ̇y of each window, which is −∫ψẏ.

        The window's first value is subtracted: a constant must not count, even across gaps.
        """
        return np.array(
            [bump_slope @ (series[rows] - series[rows.start]) for rows, _, bump_slope in self._rows]
        )


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


def correlation_length(series: np.ndarray) -> float:
    """1 + 2Σρ of a series (n,), up to the first ρ that is not positive."""
    rho = autocorrelations(series)
    end = int(np.argmax(rho <= 0.0)) if np.any(rho <= 0.0) else len(rho)
    return float(1.0 + 2.0 * np.sum(rho[:end]))


def autocorrelations(series: np.ndarray) -> np.ndarray:
    """ρ (n − 1,) of a series (n,) at the lags 1, 2, …; zeros for a constant series."""
    n = len(series)
    spectrum = np.abs(np.fft.rfft(series - np.mean(series), 2 * n)) ** 2
    correlation = np.fft.irfft(spectrum)[:n]
    if correlation[0] <= 0.0:
        return np.zeros(n - 1)
    rho: np.ndarray = correlation[1:] / correlation[0]
    return rho


def coloured_part(series: np.ndarray) -> float:
    """Part [%] of the first autocorrelations outside the band of white noise; about 5 if white."""
    known = series[np.isfinite(series)]
    if len(known) <= LAGS:
        return float("nan")
    outside = np.abs(autocorrelations(known)[:LAGS]) > BAND / np.sqrt(len(known))
    return float(100.0 * np.mean(outside))
