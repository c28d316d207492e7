"""How far the residuals of a fit are from white noise."""

import numpy as np

# Lags [samples] of the autocorrelations that are counted.
LAGS = 25
# Half width of the band that holds 95 % of the autocorrelations of white noise, times √n.
BAND = 1.96


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
