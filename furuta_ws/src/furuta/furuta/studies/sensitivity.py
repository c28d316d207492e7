"""How the limit cycle that remains with compensation grows with the sensor noise.

Noise is given in multiples of the rig's, which is one code of each analogue channel. The filter of
the estimator is designed for the actual noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from furuta_friction.compensation import ObserverParameters
from furuta_model.sensors import Sensors
from furuta_sim.lanes.batch import batch
from furuta_sim.simulation.closed_loop import Loop

METHODS = ("kalman", "lowpass")
# Last part of a run that is measured.
SETTLED = 0.75


class SensitivityRow(NamedTuple):
    """The arm's peak-to-peak angle [rad] of one case: smallest, mean and largest over the seeds."""

    method: str
    compensation: str
    noise: float
    smallest: float
    mean: float
    largest: float


def run_sensitivity(
    loop: Loop,
    compensations: dict[str, ObserverParameters],
    noises: Sequence[float],
    seeds: Sequence[int],
    seconds: float,
) -> list[SensitivityRow]:
    """Simulate every estimator with every compensation (by name) at every noise and seed.

    A compensation that needs the observed friction is left out if the estimator provides none.
    """
    cases = [
        (method, name, noise)
        for method, name, noise in product(METHODS, compensations, noises)
        if loop.estimator._replace(method=method).chosen.observes_friction
        or not compensations[name].chosen.needs_observed_friction
    ]
    loops = (
        _with_noise(loop, method, compensations[name], noise, seed)
        for method, name, noise in cases
        for seed in seeds
    )
    sizes = [each.phi_peak_to_peak_rad for each in batch(loops, seconds, SETTLED)]
    rows = np.reshape(sizes, (len(cases), len(seeds)))
    return [
        SensitivityRow(*case, float(row.min()), float(row.mean()), float(row.max()))
        for case, row in zip(cases, rows, strict=True)
    ]


def _with_noise(
    loop: Loop, method: str, observer: ObserverParameters, noise: float, seed: int
) -> Loop:
    sensors = _scale_noise(loop.plant.sensors, noise)
    return loop._replace(
        plant=loop.plant._replace(sensors=sensors, seed=seed),
        estimator=loop.estimator._replace(
            method=method, sensors=_scale_noise(loop.estimator.sensors, noise)
        ),
        observer=observer,
    )


def _scale_noise(sensors: Sensors, factor: float) -> Sensors:
    return sensors._replace(
        tachometer_noise=factor * sensors.tachometer_noise,
        potentiometer_noise=factor * sensors.potentiometer_noise,
    )
