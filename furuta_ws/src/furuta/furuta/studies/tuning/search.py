"""Search over compensator parameters for the smallest amplitude, with COBYQA."""

from collections.abc import Callable
from math import log

import numpy as np
from scipy.optimize import minimize

from furuta_friction.compensation import ObserverParameters
from furuta_model.parameters import build, declared, values

# One step of the search multiplies by a factor, or adds a difference if 0 is a valid value.
STEP_FACTORS = {
    "sigma0": 1.5,
    "sigma1": 1.5,
    "alpha0": 1.04,
    "alpha1": 1.6,
    "stribeck_velocity": 1.6,
}
STEP_DIFFERENCES = {"viscous": 0.01, "asymmetry": 0.05, "observer_gain": 0.02}
SEARCHABLE = (*STEP_FACTORS, *STEP_DIFFERENCES)
# Initial and final radius of the trust region, in steps.
INITIAL_RADIUS, FINAL_RADIUS = 0.6, 0.1
# Least amplitude that the search distinguishes from 0 [rad].
SMALLEST_AMPLITUDE = 1e-12

_DECLARATIONS = {item.name: item.about for item in declared(ObserverParameters)}


def minimise_amplitude(
    amplitude: Callable[[ObserverParameters], float],
    start: ObserverParameters,
    names: tuple[str, ...],
    max_trials: int,
) -> None:
    """Evaluate ``amplitude`` at candidates that differ from ``start`` in the parameters ``names``.

    The candidates are recorded by ``amplitude`` itself. Without names ``start`` is the only one.
    """
    if not names:
        amplitude(start)
        return
    minimize(
        lambda steps: log(max(amplitude(with_steps(start, names, steps)), SMALLEST_AMPLITUDE)),
        np.zeros(len(names)),
        method="COBYQA",
        options={
            "maxfev": max_trials,
            "initial_tr_radius": INITIAL_RADIUS,
            "final_tr_radius": FINAL_RADIUS,
        },
    )


def with_steps(
    observer: ObserverParameters, names: tuple[str, ...], steps: np.ndarray
) -> ObserverParameters:
    """The parameters changed by ``steps`` (one per name), limited to their declared ranges."""
    changed = values(observer)
    for name, step in zip(names, steps, strict=True):
        factor, old = STEP_FACTORS.get(name), changed[name]
        new = old * factor**step if factor else old + STEP_DIFFERENCES[name] * step
        allowed = _DECLARATIONS[name]
        changed[name] = float(min(max(new, allowed.low), allowed.high))
    return build(ObserverParameters, changed)
