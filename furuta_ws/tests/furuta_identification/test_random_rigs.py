r"""Random rigs: nothing is decided wrongly, and standard errors hold.

    FURUTA_RIGS=200 tools/in_environment python -m pytest --capture=no \
        furuta_ws/tests/furuta_identification/test_random_rigs.py

tries 200 rigs and fits every tenth of them; by default a few are tried and none is fitted.
"""

from __future__ import annotations

import os

import numpy as np
import pytest
from random_rigs import KINDS, Readings, Rig, random_readings, random_rig, record

from furuta_identification.fitting.first_estimate import first_estimate
from furuta_identification.fitting.identify import identify
from furuta_identification.fitting.report import summary
from furuta_identification.preparation.options import Options
from furuta_identification.preparation.prepare import prepare_all
from furuta_identification.regression.speeds import speed_lag
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

RIGS = int(os.environ.get("FURUTA_RIGS", "8"))
FITTED = range(0, RIGS, 10) if "FURUTA_RIGS" in os.environ else range(0)
# Largest and smallest amplitude of the command [V], and length of a recording [s].
AMPLITUDES, SECONDS = (1.0, 6.0), 6.0
ERRORS = 2.0


def sampled(seed: int) -> tuple[Rig, Readings, Recording]:
    """A random rig, how it is recorded, and a recording of it."""
    rng = np.random.default_rng(seed)
    rig, readings = random_rig(rng), random_readings(rng)
    amplitude = float(rng.uniform(*AMPLITUDES))
    kind = KINDS[seed % len(KINDS)]
    return rig, readings, record(rig, kind, amplitude, SECONDS, readings, rng, f"{seed} {kind}")


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


def truth(rig: Rig) -> dict[str, float]:
    """True values of what `identify` reports."""
    level = 0.5 * (rig.forward + rig.backward)
    return {
        "alpha": rig.alpha,
        "beta": rig.beta,
        "gamma": rig.gamma,
        "delta": rig.delta,
        "natural_frequency_rad_s": float(np.sqrt(rig.delta / rig.beta)),
        "viscous": rig.viscous,
        "coulomb": level,
        "asymmetry": 0.5 * (rig.forward - rig.backward) / level,
        "pendulum_viscous": rig.pendulum_viscous,
    }


def deviations(rig: Rig, recording: Recording) -> dict[str, float]:
    """Deviations from the truth in standard errors, of what the data determine."""
    found = summary(identify([recording], Options()))
    errors = found["standard_errors"]
    return {
        name: (found[name] - value) / errors[name]
        for name, value in truth(rig).items()
        if found[name] is not None and errors[name] is not None
    }


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


@pytest.mark.skipif(not FITTED, reason="takes minutes: set FURUTA_RIGS")
@pytest.mark.timeout(36_000)
def test_standard_errors_hold() -> None:
    """The truth lies within two standard errors for most rigs."""
    found: dict[str, list[float]] = {}
    for seed in FITTED:
        rig, _, recording = sampled(seed)
        try:
            values = deviations(rig, recording)
        except ParameterError:
            continue
        print(recording.name, {name: round(value, 1) for name, value in values.items()})
        for name, value in values.items():
            found.setdefault(name, []).append(value)
    for name, series in found.items():
        within = 100.0 * np.mean(np.abs(series) <= ERRORS)
        print(f"{name}: {within:.0f} % of {len(series)} within {ERRORS:g} standard errors")
    assert found
