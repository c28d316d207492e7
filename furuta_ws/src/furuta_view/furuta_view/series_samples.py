"""Samples of a simulation's file, or of another table of series, as those of a recording."""

from pathlib import Path
from typing import Any

import numpy as np

from furuta.studies.series import series_with_findings
from furuta_view.samples import COLUMNS, TIME

# Names of the columns of a sample; what the estimator says stands in for what is not known.
_NAMES = (
    ("time_s",),
    ("true_phi_rad", "estimated_phi_rad", "measured_phi_rad"),
    ("true_phi_dot_rad_s", "estimated_phi_dot_rad_s", "measured_phi_dot_rad_s"),
    ("true_theta_rad", "estimated_theta_rad", "measured_theta_rad"),
    ("true_theta_dot_rad_s", "estimated_theta_dot_rad_s", "measured_theta_dot_rad_s"),
    ("true_friction_v",),
    ("friction_estimate_v",),
    ("command_v",),
)
# Most samples in a second that are shown.
RATE = 100.0


class SeriesSamples:
    """A file of series; ``seconds`` is its length."""

    def __init__(self, path: Path) -> None:
        self.path = path
        series = series_with_findings(path)[0]
        unknown = np.full(len(series["time_s"]), np.nan)
        rows = [next((series[n] for n in names if n in series), unknown) for names in _NAMES]
        samples = np.array(rows).reshape(COLUMNS, -1).T
        self.seconds = float(samples[-1, TIME])
        self._samples = samples[:: max(1, int(len(samples) / (RATE * max(self.seconds, 1e-3))))]

    def close(self) -> None:
        """Do nothing: the file is read."""

    def parameters(self) -> dict[str, dict[str, Any]]:
        """Nothing: a file of series has no parameters."""
        return {}

    def window(self, end: float, seconds: float) -> np.ndarray:
        """The samples (n, 8) of the ``seconds`` before ``end``."""
        times = self._samples[:, TIME]
        return self._samples[(times > end - seconds) & (times <= end)]
