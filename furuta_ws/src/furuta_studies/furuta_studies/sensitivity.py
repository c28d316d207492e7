"""How the limit cycle that compensation leaves grows with the sensors' noise.

Noise is in multiples of the rig's, one code of each analogue channel. The estimator is told: its
filter is designed for the noise that there is.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from furuta_analysis.simulation.batch import batch
from furuta_analysis.simulation.closed_loop import Loop
from furuta_friction.compensation import ObserverParameters
from furuta_model.sensors import Sensors

METHODS = ("kalman", "lowpass")
# Part of a run that is measured.
SETTLED = 0.75


class Sensitivity(NamedTuple):
    """Arm, peak to peak [rad], smallest, mean and largest over the seeds."""

    method: str
    compensation: str
    noise: float
    smallest: float
    mean: float
    largest: float


def sensitivity(
    loop: Loop,
    compensations: dict[str, ObserverParameters],
    noises: Sequence[float],
    seeds: Sequence[int],
    seconds: float,
) -> list[Sensitivity]:
    """Every estimator with every compensation (by name) at every noise, over all seeds.

    Left out are those that need to see the friction with a filter that does not.
    """
    cases = [
        (method, name, noise)
        for method, name, noise in product(METHODS, compensations, noises)
        if loop.estimator._replace(method=method).chosen.observes_friction
        or not compensations[name].chosen.needs_observed_friction
    ]
    loops = (
        _noisy(loop, method, compensations[name], noise, seed)
        for method, name, noise in cases
        for seed in seeds
    )
    sizes = [each.phi_peak_to_peak_rad for each in batch(loops, seconds, SETTLED)]
    rows = np.reshape(sizes, (len(cases), len(seeds)))
    return [
        Sensitivity(*case, float(row.min()), float(row.mean()), float(row.max()))
        for case, row in zip(cases, rows, strict=True)
    ]


def _noisy(loop: Loop, method: str, observer: ObserverParameters, noise: float, seed: int) -> Loop:
    sensors = _louder(loop.plant.sensors, noise)
    return loop._replace(
        plant=loop.plant._replace(sensors=sensors, seed=seed),
        estimator=loop.estimator._replace(
            method=method, sensors=_louder(loop.estimator.sensors, noise)
        ),
        observer=observer,
    )


def _louder(sensors: Sensors, factor: float) -> Sensors:
    return sensors._replace(
        tachometer_noise=factor * sensors.tachometer_noise,
        potentiometer_noise=factor * sensors.potentiometer_noise,
    )
