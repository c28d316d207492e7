"""Integrals of a recording's series over short windows, which need no derivative of noisy data."""

from __future__ import annotations

import numpy as np

from furuta_model.parameters import ParameterError

# Length of a window [s]: long against noise, short against the unstable pole.
WINDOW = 0.2
# Windows that a recording must have.
FEWEST = 12


class Windows:
    """Integrals over bumps (1 − s²)³, s from −1 to 1, half overlapping, one a row."""

    def __init__(self, time: np.ndarray) -> None:
        half = 0.5 * WINDOW
        centres = np.arange(time[0] + half, time[-1] - half, half)
        if len(centres) < FEWEST:
            raise ParameterError(
                f"the recording is too short: {time[-1] - time[0]:.2f} s with data, at least "
                f"{(FEWEST + 2) * half:.1f} s needed"
            )
        weights = np.gradient(time)
        self._rows = []
        for centre in centres:
            a, b = np.searchsorted(time, (centre - half, centre + half))
            if a == b:
                continue
            s = (time[a:b] - centre) / half
            bump = weights[a:b] * (1.0 - s * s) ** 3
            steep = weights[a:b] * -6.0 * s * (1.0 - s * s) ** 2 / half
            self._rows.append((slice(a, b), bump, steep))

    def mean(self, series: np.ndarray) -> np.ndarray:
        """∫ψy of each window."""
        return np.array([bump @ series[rows] for rows, bump, _ in self._rows])

    def slope(self, series: np.ndarray) -> np.ndarray:
        """∫ψ̇y of each window, which is −∫ψẏ; less the constant, which sums to 0 but for gaps."""
        return np.array(
            [steep @ (series[rows] - series[rows.start]) for rows, _, steep in self._rows]
        )
