r"""Random rigs: nothing is decided wrongly.

    FURUTA_RIGS=200 tools/in_environment python -m pytest --capture=no \
        furuta_ws/tests/furuta_identification/test_random_rigs.py

tries 200 rigs; by default a few are tried. benchmarks/standard_errors.py fits them.
"""

import os

import numpy as np
from random_rigs import Readings, sampled

from furuta_identification.options import Options
from furuta_identification.preparation.prepare import prepare_all
from furuta_identification.regression.first_estimate import first_estimate
from furuta_identification.regression.speeds import speed_lag
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

RIGS = int(os.environ.get("FURUTA_RIGS", "8"))


def wrong_decisions(readings: Readings, recording: Recording) -> list[str]:
    """What is decided wrongly about a recording; raises what is asked."""
    prepared = prepare_all([recording], Options())
    (ready,) = prepared.recordings
    lag = speed_lag(ready)
    estimate = first_estimate([ready], lag)
    decisions = {
        "unit": (prepared.angles == "deg") == (readings.unit != 1.0),
        "zero": bool(np.cos(ready.measured[0, 2]) < -0.8),
        "direction": prepared.direction == readings.pendulum,
        "motor": estimate.negated == (readings.motor < 0.0),
    }
    return [name for name, right in decisions.items() if not right]


def test_nothing_is_decided_wrongly() -> None:
    """Units, zeros, directions and the motor's sign; at most one in twenty, or one, is asked."""
    asked = []
    for seed in range(RIGS):
        _, readings, recording = sampled(seed)
        try:
            assert wrong_decisions(readings, recording) == [], seed
        except ParameterError as error:
            asked.append(str(error))
    print(f"{RIGS} rigs: asked {len(asked)}", *asked, sep="\n")
    assert len(asked) <= max(1, RIGS // 20)
