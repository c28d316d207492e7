r"""Transfer function G(s) of the loop from −F to the arm speed v, eq. (10), Figs 3 and 4.

.. math::
    G(s) = \frac{s(βs^2 - δ)}{(αβ-γ^2)s^4 + (γl_4-βl_2)s^3 + (γl_3-βl_1-δα)s^2 + δl_2s + δl_1}

for the feedback u = l₁φ + l₂φ̇ + l₃θ + l₄θ̇. On the imaginary axis, with a₀ … a₄ the denominator,

.. math::
    1/G(jω) = \frac{a_1ω^2 - a_3}{βω^2+δ} + j\,\frac{a_0ω^4 - a_2ω^2 + a_4}{ω(βω^2+δ)}

because ω = 0 is the only zero of the numerator there. G is therefore real exactly where
a₀ω⁴ − a₂ω² + a₄ = 0, a quadratic equation in ω².

:func:`furuta.linearize` has the same G from torque to φ̇, for plots and designs by python-control;
this one cancels s exactly if l₁ = 0, where ``minreal`` compares with a tolerance.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum

REAL = 1e-7  # relative imaginary part of a computed root that is real
# The feedbacks of Fig. 4 as l of u = l·x.
FIGURE_4: dict[str, tuple[float, float, float, float]] = {
    "a": (10.0, 4.0, 60.0, 20.0),
    "b": (0.0, 0.0, 60.0, 20.0),
    "c": (0.0, 1.0, 60.0, 20.0),
    "d": (0.0, 7.0, 60.0, 20.0),
}


class Crossing(NamedTuple):
    """Crossing of G(jω) with the negative real axis: ω [rad/s] and G there [rad/(s V)]."""

    omega_rad_s: float
    real: float


class Transfer(NamedTuple):
    """G(s) of (10): coefficients, highest power first, with common factors s."""

    numerator: tuple[float, ...]
    denominator: tuple[float, ...]

    def at(self, omega: np.ndarray | float) -> np.ndarray:
        """G(jω) [rad/(s V)] at ω > 0 [rad/s]."""
        return 1.0 / self.inverse_at(omega)

    def inverse_at(self, omega: np.ndarray | float) -> np.ndarray:
        """1/G(jω) [V s/rad] at ω > 0 [rad/s], finite everywhere."""
        s = 1j * np.asarray(omega, dtype=float)
        return np.polyval(self.denominator, s) / np.polyval(self.numerator, s)

    @property
    def cancelled(self) -> tuple[np.ndarray, np.ndarray]:
        """Numerator and denominator without the common factor s, which exists if l₁ = 0."""
        numerator, denominator = np.array(self.numerator), np.array(self.denominator)
        if denominator[-1] == 0.0:
            numerator, denominator = numerator[:-1], denominator[:-1]
        return numerator, denominator

    @property
    def static_gain(self) -> float:
        """G(0) [rad/(s V)]: 0 if l₁ ≠ 0, −1/l₂ if l₁ = 0, infinite if also l₂ = 0."""
        numerator, denominator = self.cancelled
        if denominator[-1] == 0.0:
            return float("inf")
        return float(numerator[-1] / denominator[-1])

    @property
    def poles(self) -> np.ndarray:
        """Poles of G [1/s]: those of the loop without friction, except the pole of φ if l₁ = 0."""
        return np.sort_complex(np.roots(self.cancelled[1]))

    @property
    def stable(self) -> bool:
        """Whether the loop without friction brings arm speed and pendulum to rest."""
        return bool(np.all(self.poles.real < 0.0))

    @property
    def crossings(self) -> tuple[Crossing, ...]:
        """All crossings of G(jω), ω ≥ 0, with the negative real axis, in order of ω."""
        found = []
        if self.static_gain < 0.0:
            found.append(Crossing(0.0, self.static_gain))
        for omega in self.real_frequencies:
            inverse = float(np.real(self.inverse_at(omega)))
            if inverse < 0.0:
                found.append(Crossing(omega, 1.0 / inverse))
        return tuple(found)

    @property
    def real_frequencies(self) -> tuple[float, ...]:
        """All ω > 0 [rad/s] at which G(jω) = B/D is real: roots of Im(D(jω) B(−jω))."""
        b, d = (
            np.array(part) * 1j ** np.arange(len(part) - 1, -1, -1)
            for part in (self.numerator, self.denominator)
        )
        roots = np.roots(np.polymul(d, b.conj()).imag)
        real = roots[(np.abs(roots.imag) < REAL * np.abs(roots)) & (roots.real > 0.0)].real
        return tuple(sorted(real.tolist()))


def transfer(p: FurutaPendulum, feedback: Sequence[float]) -> Transfer:
    """G(s) of (10) for u = l·x, ``feedback`` = l (4,) in the order (φ, φ̇, θ, θ̇) [V/x]."""
    l1, l2, l3, l4 = checked_feedback(feedback)
    return Transfer(
        (p.beta, 0.0, -p.delta, 0.0),
        (
            p.determinant,
            p.gamma * l4 - p.beta * l2,
            p.gamma * l3 - p.beta * l1 - p.delta * p.alpha,
            p.delta * l2,
            p.delta * l1,
        ),
    )


def joint_transfer(a: np.ndarray, b: np.ndarray) -> Transfer:
    """G(s) from a force on a joint to its speed, which is the first state of ẋ = A x + b f.

    It is B/D with D(s) = det(sI − A) and B(s) = det(sI − A + b c) − D(s).
    """
    fed_back = a.copy()
    fed_back[:, 0] -= b
    denominator = np.poly(a)
    numerator = (np.poly(fed_back) - denominator)[1:]
    return Transfer(tuple(numerator.tolist()), tuple(denominator.tolist()))


def checked_feedback(feedback: Sequence[float]) -> tuple[float, float, float, float]:
    """The feedback as four finite numbers, or :class:`ParameterError`."""
    values = tuple(float(each) for each in feedback)
    if len(values) != 4 or not np.all(np.isfinite(values)):
        given = ", ".join(f"{each:g}" for each in values)
        raise ParameterError(
            f"feedback must be four finite numbers (phi, phi_dot, theta, theta_dot), given {given}"
        )
    return values
