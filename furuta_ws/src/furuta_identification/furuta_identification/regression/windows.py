"""Integrals of a recording over short windows, which need no derivative of noisy data."""

import numpy as np

from furuta_model.parameters import ParameterError

# Length of a window [s]: long compared with noise, short compared with the unstable pole.
WINDOW = 0.2
FEWEST_WINDOWS = 12


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
