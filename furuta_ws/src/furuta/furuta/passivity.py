r"""Passivity condition for convergence of the observer (9) with its correction −Kφ, [6], [10].

Near upright, with the true model, a known speed and u = l·x + F̂, the errors z̃ = z − ẑ and
F̃ = F − F̂ = σ₀z̃ + σ₁ż̃ obey

.. math::
    \dot x = (A + Bl)x - B\tilde F, \qquad
    \dot{\tilde z} = -σ_0\frac{|v|}{g(v)}\tilde z + Ke

so e = −G z̃ with the denominator of (10) in

.. math::
    G(s) = \frac{(σ_1s + σ_0)(βs^2 - δ)}{a_0s^4 + a_1s^3 + a_2s^2 + a_3s + a_4}

The leak of the bristle makes the map Ke → z̃ passive. Hence x, e and F̃ would converge to zero if
±G with the sign of K were strictly positive real. No feedback l makes it so: the zero √(δ/β) of the
pendulum is in the right half plane, where such a function has none (Khalil, *Nonlinear Systems*,
Lemma 6.1). If the leak is known to be at least λ, it is enough that K G + λ is positive real:
λ = −min Re KG. At rest there is no leak, and the remaining loop is linear, s + K G(s) = 0.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.transfer import transfer
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum

POINTS, SPAN = 20_000, 1e3  # of the grid over ω, and how far it is beyond the poles


class Passivity(NamedTuple):
    """The result for a correction gain K [1/s].

    Attributes:
        satisfied: Whether the passivity condition holds.
        reason: Why it does not.
        smallest_real_part: Minimum of Re ±G(jω), with the sign of K; NaN if the loop without
            friction is unstable.
        at_omega_rad_s: Frequency of this minimum.
        holds_above_rad_s: Arm speed above which the condition holds thanks to the leak.
        fastest_growth: Real part of the rightmost pole of the loop without leak at this K [1/s].
    """

    satisfied: bool
    reason: str
    smallest_real_part: float
    at_omega_rad_s: float
    holds_above_rad_s: float
    fastest_growth: float


def observer_passivity(ideal: IdealLoop, gain: float) -> Passivity:
    """The condition for the loop's feedback and friction, and an observer with gain K [1/s]."""
    friction = ideal.law.parameters
    numerator, denominator = error_loop(ideal.body, ideal.gains, friction)
    sign, (smallest, omega) = "", _smallest(numerator, denominator)
    if gain < 0.0:
        sign, (smallest, omega) = "-", _smallest(-numerator, denominator)
    zero = np.sqrt(ideal.body.delta / ideal.body.beta)
    reason = (
        f"{sign}G, with the sign of K, is not strictly positive real: it has the zero {zero:.4g} "
        "1/s in the right half plane, whatever the feedback"
    )
    if gain == 0.0:
        reason = "with K = 0 there is no correction: z̃ decays only with the distance travelled"
    needed = abs(gain) * max(-smallest, 0.0) * highest_level(friction) / friction.sigma0
    without_leak = np.polyadd(np.append(denominator, 0.0), gain * numerator)
    growth = float(np.max(np.roots(without_leak).real))
    return Passivity(False, reason, smallest, omega, float(needed), growth)


def error_loop(
    p: FurutaPendulum, feedback: Sequence[float], friction: Friction
) -> tuple[np.ndarray, np.ndarray]:
    """Numerator and denominator of G for ``feedback`` = l (4,), highest power first."""
    g = transfer(p, feedback)
    # φ/u is G of (10), that is v/u, without the factor s.
    product = np.polymul([friction.sigma1, friction.sigma0], g.numerator[:-1])
    return np.trim_zeros(product, "f"), np.array(g.denominator)


def _smallest(numerator: np.ndarray, denominator: np.ndarray) -> tuple[float, float]:
    """Minimum of Re G(jω) and its ω [rad/s]; NaN if G is unstable."""
    poles = np.roots(denominator)
    if not np.all(poles.real < 0.0):
        return np.nan, np.nan
    sizes = np.abs(poles)
    omega = np.append(0.0, np.geomspace(sizes.min() / SPAN, sizes.max() * SPAN, POINTS))
    real = (np.polyval(numerator, 1j * omega) / np.polyval(denominator, 1j * omega)).real
    least = int(np.argmin(real))
    return float(real[least]), float(omega[least])
