"""Linear regression on integrals over short windows, which need no derivative of noisy data."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array

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
    """Averages weighted by bumps ψ ∝ (1 − s²)³, s from −1 to 1, ``apart`` of a length each.

    Derivatives are integrated by parts: of a series only its values count. A series is (n,), or
    (n, c) with a column each. ``starts`` (k,) [s] are the beginnings of the windows.
    """

    def __init__(self, time: np.ndarray, length: float = WINDOW, apart: float = 0.5) -> None:
        half = 0.5 * length
        centres = np.arange(time[0] + half, time[-1] - half, apart * length)
        if len(centres) < FEWEST_WINDOWS:
            raise ParameterError(
                f"the recording is too short: {time[-1] - time[0]:.2f} s with data, at least "
                f"{shortest(length, apart):.1f} s needed"
            )
        edges = np.searchsorted(time, (centres - half, centres + half)).T
        some = edges[:, 1] > edges[:, 0]
        centres, edges = centres[some], edges[some]
        weights, unit = np.gradient(time), half ** np.arange(3.0)[:, None]
        bumps = np.hstack(
            [
                _bumps((time[a:b] - centre) / half, weights[a:b]) / unit
                for centre, (a, b) in zip(centres, edges, strict=True)
            ]
        )
        columns = np.concatenate([np.arange(a, b) for a, b in edges])
        ends = np.append(0, np.cumsum(edges[:, 1] - edges[:, 0]))
        shape = len(centres), len(time)
        self._sums = [csr_array((values, columns, ends), shape) for values in bumps]
        self.starts = centres - half

    def mean(self, series: np.ndarray) -> np.ndarray:
        """The mean ∫ψy of each window."""
        mean: np.ndarray = self._sums[0] @ series
        return mean

    def slope(self, series: np.ndarray) -> np.ndarray:
        """The mean slope ∫ψẏ = −∫ψ̇y of each window; a constant does not count."""
        slope: np.ndarray = -self._sums[1] @ (series - series[0])
        return slope

    def curvature(self, series: np.ndarray) -> np.ndarray:
        """The mean second derivative ∫ψÿ = ∫ψ̈y of each window; a straight line does not count."""
        curvature: np.ndarray = self._sums[2] @ (series - series[0])
        return curvature

    def noise(self, order: int) -> float:
        """Standard deviation of a derivative of this order, for white noise with that of 1."""
        sums = self._sums[order]
        return float(np.sqrt(sums.power(2).sum() / sums.shape[0]))


def _bumps(s: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weights (3, n) of sums for ∫ψy, ∫ψ̇y and ∫ψ̈y over −1 to 1, whose samples have weights.

    The sums of the derivatives are corrected to be exact for parabolas: an error in proportion to
    the slope would count as friction.
    """
    inside = 1.0 - s * s
    weights = weights / np.sum(weights * inside**3)
    bump = weights * inside**3
    slope = weights * -6.0 * s * inside**2
    curvature = weights * 6.0 * (5.0 * s * s - 1.0) * inside
    powers = np.array((np.ones(len(s)), s, s * s))
    mean = powers @ bump
    wanted = np.array(((0.0, -mean[0], -2.0 * mean[1]), (0.0, 0.0, 2.0 * mean[0])))
    derivatives = np.array((slope, curvature))
    basis = powers * bump
    missing = wanted - derivatives @ powers.T
    derivatives += missing @ np.linalg.pinv(basis @ powers.T) @ basis
    return np.array((bump, *derivatives))


def shortest(length: float = WINDOW, apart: float = 0.5) -> float:
    """Duration [s] of which the windows are just enough."""
    return (1.0 + apart * FEWEST_WINDOWS) * length


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
