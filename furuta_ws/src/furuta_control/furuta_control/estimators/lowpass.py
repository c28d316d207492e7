"""The paper's filter, Section 4: a low-pass on the potentiometer whose state is the speed.

    ÿ = ω²(θ_measured − y) − 2ζω ẏ

It is sampled exactly for a measurement that varies linearly between samples (first-order hold).
"""

from __future__ import annotations

from math import nan
from typing import Annotated, NamedTuple

import numpy as np
from scipy.linalg import expm

from furuta_control.estimators.rig import NominalRig
from furuta_model.compiled import inlined
from furuta_model.parameters import About
from furuta_model.state import OBSERVED_FRICTION, PHI, PHI_DOT, THETA, THETA_DOT

# What the filter keeps besides its estimate: the previous measurement of θ.
MEMORY = 1


class LowpassParameters(NamedTuple):
    """The filter on the potentiometer."""

    filter_bandwidth: Annotated[
        float, About("natural frequency of the potentiometer's filter", "rad/s", 0.1, 1e5)
    ] = 200.0
    filter_damping: Annotated[
        float, About("damping ratio of the potentiometer's filter", "", 0.1, 10.0)
    ] = 0.7


class Lowpass(NamedTuple):
    """The filter as it runs: ``step`` (2, 4) of one sample, ``lag`` [s] behind a ramp.

    (θ, θ̇)⁺ is ``step`` times (θ, θ̇, measured before, measured now).
    """

    step: np.ndarray
    lag: float


def design(rig: NominalRig, p: LowpassParameters) -> Lowpass:
    """The filter for a rig, exact by the exponential of the system and its linear input."""
    omega, zeta, dt = p.filter_bandwidth, p.filter_damping, rig.sample_time
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-(omega**2), -2.0 * zeta * omega, omega**2, 0.0]
    system[2, 3] = 1.0 / dt
    step = expm(system * dt)[:2]
    # The input's states are its value before and its rise; the rise is the difference to now.
    step[:, 2] -= step[:, 3]
    return Lowpass(np.ascontiguousarray(step), 2.0 * zeta / omega)


@inlined
def begin(memory: np.ndarray, at: int, measurement: np.ndarray, p: Lowpass) -> None:
    """Begin where a filter that follows the estimated speed would be; no friction is observed."""
    memory[THETA] -= p.lag * memory[THETA_DOT]
    memory[at] = measurement[THETA]
    memory[OBSERVED_FRICTION] = nan


@inlined
def update(memory: np.ndarray, at: int, measurement: np.ndarray, p: Lowpass) -> None:
    """One sample: the estimate, ``memory``'s first (5,), is moved; own memory is from ``at``."""
    step = p.step
    y, y_dot, before, now = memory[THETA], memory[THETA_DOT], memory[at], measurement[THETA]
    memory[PHI], memory[PHI_DOT] = measurement[PHI], measurement[PHI_DOT]
    memory[THETA] = step[0, 0] * y + step[0, 1] * y_dot + step[0, 2] * before + step[0, 3] * now
    memory[THETA_DOT] = step[1, 0] * y + step[1, 1] * y_dot + step[1, 2] * before + step[1, 3] * now
    memory[at] = now
