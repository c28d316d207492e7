"""Low-pass filter of the paper, Section 4: estimates the pendulum from the potentiometer.

    ÿ = ω²(θ_measured − y) − 2ζω ẏ

y is the estimate of θ, ẏ that of θ̇. The filter is sampled exactly for a measurement that varies
linearly between samples (first-order hold).
"""

from math import nan
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.parameters import About
from furuta_model.state import OBSERVED_FRICTION, PHI, PHI_DOT, THETA, THETA_DOT


class LowpassParameters(NamedTuple):
    """The filter on the potentiometer."""

    filter_bandwidth: Annotated[
        float, About("natural frequency of the filter on the potentiometer", "rad/s", 0.1, 1e5)
    ] = 200.0
    filter_damping: Annotated[
        float, About("damping ratio of the filter on the potentiometer", "", 0.1, 10.0)
    ] = 0.7


class Lowpass(NamedTuple):
    """The sampled filter: ``step`` (2, 4) of one sample, ``lag`` [s] behind a ramp.

    (θ, θ̇)⁺ is ``step`` times (θ, θ̇, previous measurement, measurement).
    """

    step: np.ndarray
    lag: float


def design(p: LowpassParameters, dt: float) -> Lowpass:
    """The filter for a sample time, by the matrix exponential of the system with linear input."""
    from scipy.linalg import expm  # slow; not every node needs it

    omega, zeta = p.filter_bandwidth, p.filter_damping
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-(omega**2), -2.0 * zeta * omega, omega**2, 0.0]
    system[2, 3] = 1.0 / dt
    step = expm(system * dt)[:2]
    # The input's states are its previous value and its rise, the difference to the new value.
    step[:, 2] -= step[:, 3]
    return Lowpass(np.ascontiguousarray(step), 2.0 * zeta / omega)


@inlined
def begin(x: np.ndarray, last: np.ndarray, measurement: np.ndarray, p: Lowpass) -> None:
    """Start in the steady state for the estimated speed; no friction is observed."""
    last[THETA] = measurement[THETA]
    x[THETA] -= p.lag * x[THETA_DOT]
    x[OBSERVED_FRICTION] = nan


@inlined
def update(x: np.ndarray, last: np.ndarray, measurement: np.ndarray, p: Lowpass) -> None:
    """Move the estimate ``x`` by one sample with a ``measurement`` (5,) after the ``last`` one."""
    step, previous = p.step, last[THETA]
    y, y_dot, new = x[THETA], x[THETA_DOT], measurement[THETA]
    x[PHI], x[PHI_DOT] = measurement[PHI], measurement[PHI_DOT]
    x[THETA] = step[0, 0] * y + step[0, 1] * y_dot + step[0, 2] * previous + step[0, 3] * new
    x[THETA_DOT] = step[1, 0] * y + step[1, 1] * y_dot + step[1, 2] * previous + step[1, 3] * new
