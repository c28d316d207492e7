"""Whether a model describes its recordings: fits of arm and pendulum, colour of the residuals."""

from typing import Any

import numpy as np

from furuta_identification.model import Prediction
from furuta_identification.regression.autocorrelation import coloured_part
from furuta_recordings.recording import CHANNELS

# Fit [%] of a joint below which the parameters are meaningless, and below which they are doubtful.
SMALLEST_FIT, DOUBTFUL_FIT = 50.0, 80.0
# A joint's fit is that of the first of its channels that was measured.
JOINTS = {"arm": ("arm speed", "arm angle"), "pendulum": ("pendulum angle",)}


def verdict(predictions: list[Prediction]) -> dict[str, Any]:
    """``usable`` (yes, doubtful, no) with ``reasons``, and the ``coloured`` part of residuals [%].

    White residuals have 5 % of their autocorrelations outside the band. More show what the model
    lacks: the standard errors count for that, a noise model would not.
    """
    reasons, worst = [], 100.0
    for prediction in predictions:
        fits = prediction.fits()
        for joint, channels in JOINTS.items():
            known = [fits[name] for name in channels if not np.isnan(fits[name])]
            if known and known[0] < DOUBTFUL_FIT:
                reasons.append(f"{prediction.recording.name}: fit of the {joint} {known[0]:.0f} %")
                worst = min(worst, known[0])
    usable = "no" if worst < SMALLEST_FIT else "doubtful" if reasons else "yes"
    return {
        "usable": usable,
        "reasons": reasons,
        "coloured_percent": {p.recording.name: _colours(p) for p in predictions},
    }


def _colours(prediction: Prediction) -> dict[str, float]:
    """Part [%] of the residuals' first autocorrelations outside the band of white noise."""
    residuals = prediction.recording.measured - prediction.predicted
    return {
        name.replace(" ", "_"): coloured_part(residuals[:, k]) for k, name in enumerate(CHANNELS)
    }
