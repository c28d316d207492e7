"""Errors of sensors from their series, and errors of a fit from blocks of time."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from furuta_recordings.recording import Recording

# Smallest eigenvalue of a scaled information, in the largest, that is no rounding; and the standard
# error of a direction that is not determined, in sizes.
UNKNOWN, ANYTHING = 1e-13, 100.0
# No sensor is better than this [rad, rad/s, rad, rad/s].
SMALLEST_NOISE = (1e-5, 1e-4, 1e-5, 1e-4)


def quantisation_step(series: np.ndarray) -> float:
    """The smallest change of a series (n,); 0 if it never changes."""
    changes = np.abs(np.diff(series[np.isfinite(series)]))
    smallest = float(np.min(changes[changes > 1e-12], initial=np.inf))
    return smallest if np.isfinite(smallest) else 0.0


def series_noise(time: np.ndarray, series: np.ndarray) -> float:
    """Standard deviation of a series' error: of its quantisation, or of white noise if larger.

    That is the one of differences of four samples that leave parabolas out.
    """
    t, y = (sliding_window_view(values, 4) for values in (time, series))
    weights = 1.0 / np.prod(t[:, :, None] - t[:, None] + np.eye(4), axis=2)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    white = float(np.mean(np.sum(weights * y, axis=1) ** 2))
    return float(np.sqrt(max(white, quantisation_step(series) ** 2 / 12.0)))


def noise_of(recording: Recording) -> np.ndarray:
    """Standard deviation of each channel's error (4,); 1 where nothing was measured."""
    sizes = [
        max(series_noise(recording.time, column), smallest)
        for column, smallest in zip(recording.measured.T, SMALLEST_NOISE, strict=True)
    ]
    return np.where(np.isfinite(sizes), sizes, 1.0)


def inverse(matrix: np.ndarray, prior: np.ndarray | float = 0.0) -> np.ndarray:
    """Inverse (..., p, p) of an information in any units, of which ``prior`` (p,) is a part.

    A direction that it does not determine is as uncertain as before; a pseudo-inverse would call it
    exact.
    """
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    values, vectors = np.linalg.eigh(matrix * (scale[..., :, None] * scale[..., None, :]))
    vectors = scale[..., :, None] * vectors
    unknown = values < UNKNOWN * np.max(values, axis=-1, keepdims=True, initial=1e-300)
    least = np.broadcast_to(prior, diagonal.shape) + 1.0 / ANYTHING**2
    loose = np.sum(least[..., :, None] * vectors**2, axis=-2)
    kept = np.where(unknown, loose, values)
    found: np.ndarray = (vectors / kept[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    return found


def at_least(covariance: np.ndarray, least: np.ndarray) -> np.ndarray:
    """A covariance (p, p), made as large as another one in every direction."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(least), 1e-300))
    both = np.outer(scale, scale)
    values, vectors = np.linalg.eigh(least * both)
    root = np.sqrt(np.maximum(values, 1e-15 * values[-1]))
    whitened = (vectors / root).T @ (covariance * both) @ (vectors / root)
    sizes, turned = np.linalg.eigh(whitened)
    back = vectors * root @ turned
    found: np.ndarray = (back * np.maximum(sizes, 1.0)) @ back.T / both
    return found


def jackknife(
    information: np.ndarray,
    blocks: np.ndarray,
    scores: np.ndarray,
    prior: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Covariance (p, p) of a fit by leaving out one block of time after the other.

    ``blocks`` (b, p, p) are the blocks' parts of the information, ``scores`` (b, p) those of the
    gradient. This is the cluster jackknife CR3 (MacKinnon, Nielsen and Webb 2023) with one
    Gauss-Newton step per block: within a block residuals may be correlated in any way. With few
    blocks a sandwich estimate ignores how much each of them has influenced the fit.
    """
    left = inverse(information - blocks, prior)
    # A block may be all that tells of a direction.
    shift = np.clip(np.einsum("bij,bj->bi", left, scores), -ANYTHING, ANYTHING)
    covariance: np.ndarray = (len(shift) - 1) / len(shift) * shift.T @ shift
    return covariance
