"""Linear algebra of the segments' initial states: each segment's rows and its own state only.

A residual vector (4n + 5s,) of a recording has the n samples of four channels, then the five
initial states of s segments.
"""

import numpy as np

from furuta_identification.shooting.segments import Segments
from furuta_model.state import PLANT_STATES, RIGID_STATES


def segment_rows(part: Segments) -> list[np.ndarray]:
    """The rows of each segment in a residual vector."""
    n = len(part.recording.time)
    first = RIGID_STATES * np.append(part.starts, n)
    own = RIGID_STATES * n + PLANT_STATES * np.arange(len(part.starts) + 1)
    return [
        np.append(np.arange(first[s], first[s + 1]), np.arange(own[s], own[s + 1]))
        for s in range(len(part.starts))
    ]


def sums_of_squares(residuals: np.ndarray, part: Segments) -> np.ndarray:
    """Sum of squares of each segment (s,)."""
    outputs = RIGID_STATES * len(part.recording.time)
    squares = residuals**2
    sums: np.ndarray = np.add.reduceat(squares[:outputs], RIGID_STATES * part.starts)
    return sums + squares[outputs:].reshape(len(part.starts), -1).sum(axis=1)


def gauss_newton_steps(slopes: np.ndarray, residuals: np.ndarray, part: Segments) -> np.ndarray:
    """Step (s, 5) of each initial state, given the slopes (4n + 5s, 5) in all of them."""
    steps = np.zeros((len(part.starts), PLANT_STATES))
    for step, rows in zip(steps, segment_rows(part), strict=True):
        step[:] = np.linalg.lstsq(slopes[rows], residuals[rows], rcond=None)[0]
    return steps


def without_initial_states(columns: np.ndarray, slopes: np.ndarray, part: Segments) -> np.ndarray:
    """``columns`` minus the part that a change of each segment's initial state can explain."""
    result = columns.copy()
    for rows in segment_rows(part):
        basis, _ = np.linalg.qr(slopes[rows])
        result[rows] -= basis @ (basis.T @ columns[rows])
    return result
