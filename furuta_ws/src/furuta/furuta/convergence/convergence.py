r"""Passivity condition for convergence of the observer (9) with its correction −Ke, [6], [10].

The leak of the bristle makes the map Ke → z̃ passive. Hence, if ±G with the sign of K is strictly
positive real (G as in :mod:`.error_loop`), then x, e and F̃ converge to zero.

If the leak is known to be at least λ, it is enough that K G + λ is positive real: λ = −min Re KG.
At rest there is no leak, and the remaining loop is linear, s + K G(s) = 0; see
:attr:`Convergence.fastest_growth`.
"""

from typing import Any, NamedTuple

import numpy as np

from furuta.convergence.error_loop import ErrorLoop, error_loop, error_loop_for, passive_error
from furuta.convergence.positive_real import real_part, strictly_positive_real
from furuta.limit_cycles.ideal_loop import IdealLoop
from furuta.margins import pairs
from furuta_model.friction.lugre import highest_level
from furuta_model.friction.parameters import Friction


class Convergence(NamedTuple):
    """The result for a correction gain K [1/s].

    Attributes:
        satisfied: Whether the passivity condition holds.
        reason: Why it holds or does not.
        smallest_real_part: Minimum of Re ±G(jω), with the sign of K; NaN if the loop without
            friction is unstable.
        at_omega_rad_s: Frequency of this minimum.
        violated_rad_s: Frequency intervals in which the real part is negative.
        holds_above_rad_s: Arm speed above which the condition holds thanks to the leak.
        fastest_growth: Real part of the rightmost pole of the loop without leak at this K [1/s].
        forgetting_travel_rad: Arm travel over which z̃ decays by the factor e without correction.
    """

    satisfied: bool
    reason: str
    smallest_real_part: float
    at_omega_rad_s: float
    violated_rad_s: tuple[tuple[float, float], ...]
    holds_above_rad_s: float
    fastest_growth: float
    forgetting_travel_rad: float


def convergence(loop: ErrorLoop, gain: float, friction: Friction) -> Convergence:
    """Check the condition for an observer with gain K [1/s]."""
    sign = -1.0 if gain < 0.0 else 1.0
    numerator = sign * loop.numerator
    satisfied, reason = strictly_positive_real(numerator, loop.denominator)
    smallest, omega = np.nan, np.nan
    violated: tuple[tuple[float, float], ...] = ()
    if loop.stable:
        part = real_part(numerator, loop.denominator)
        smallest, omega = part.smallest
        violated = part.not_positive
    return Convergence(
        satisfied=satisfied and gain != 0.0,
        reason=_reason(satisfied, reason, gain),
        smallest_real_part=float(smallest),
        at_omega_rad_s=float(omega),
        violated_rad_s=violated,
        holds_above_rad_s=float(
            abs(gain) * max(-smallest, 0.0) * highest_level(friction) / friction.sigma0
        ),
        fastest_growth=_rightmost_root(loop, gain),
        forgetting_travel_rad=friction.alpha0 * (1.0 + abs(friction.asymmetry)) / friction.sigma0,
    )


class ObserverPassivity(NamedTuple):
    """The condition for a loop and its observer's gain K [1/s], with e = φ and with e = c·x.

    ``error`` is c (4,) and ``with_error`` the G for it; both are None if there is no such c.
    """

    gain: float
    loop: ErrorLoop
    convergence: Convergence
    error: np.ndarray | None
    with_error: ErrorLoop | None

    def report(self) -> dict[str, Any]:
        """Everything by name."""
        report = {
            **self.convergence._asdict(),
            "K": self.gain,
            "zeros": pairs(self.loop.zeros),
            "poles": pairs(self.loop.poles),
            "static_gain": self.loop.static_gain,
            "passive_error": None,
        }
        if self.error is not None and self.with_error is not None:
            part = real_part(self.with_error.numerator, self.with_error.denominator)
            smallest, omega = part.smallest
            report["passive_error"] = {
                "c": self.error.tolist(),
                "smallest_real_part": smallest,
                "at_omega_rad_s": omega,
            }
        return report


def observer_passivity(ideal: IdealLoop, gain: float) -> ObserverPassivity:
    """The condition for the loop's feedback and friction, and an observer with gain K [1/s]."""
    given = ideal.body, ideal.gains, ideal.law.parameters
    loop, error = error_loop(*given), passive_error(*given)
    with_error = None if error is None else error_loop_for(*given, error.tolist())
    return ObserverPassivity(
        gain, loop, convergence(loop, gain, ideal.law.parameters), error, with_error
    )


def _rightmost_root(loop: ErrorLoop, gain: float) -> float:
    """Largest real part [1/s] among the roots of s + K G(s) = 0."""
    characteristic = np.polyadd(np.append(loop.denominator, 0.0), gain * loop.numerator)
    return float(np.max(np.roots(characteristic).real))


def _reason(satisfied: bool, reason: str, gain: float) -> str:
    if gain == 0.0:
        return "with K = 0 there is no correction: z̃ decays only with the distance travelled"
    name = "G" if gain > 0.0 else "-G"
    if not satisfied:
        return f"{name}, with the sign of K, is not strictly positive real: {reason}"
    return f"{name}, with the sign of K, is strictly positive real"
