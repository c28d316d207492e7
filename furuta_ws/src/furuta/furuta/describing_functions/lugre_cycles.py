r"""Finds all zeros of the harmonic balance for LuGre, where N depends on A and ω.

The residual H(A, ω) is computed on a grid, logarithmic in ω and in the arm amplitude X = A/ω, the
scale of the bristle. H is nearly linear within a cell. A cell has no zero if its mean |H| exceeds
the variation of H from the mean to a corner; a margin allows for the curvature. Newton's method is
started from every other cell. The number of zeros is then checked: the winding number of H along
the edge of the range equals the number of zeros, each counted with the sign of its Jacobian. If
they differ, the grid is refined by a factor of 2.

The range includes every possible cycle. In ω it goes beyond all frequencies of the loop, with the
arm sliding or stuck on the bristle. In X, below a thousandth of the largest deflection friction is
a linear spring and damper; and as σ₀|z| ≤ α₀ + α₁,

.. math::
    |N - σ_2| ≤ \frac{4(α_0+α_1)}{πA}\sqrt{1 + (ωσ_1/σ_0)^2}

so at large X friction is too weak to balance 1/G.
"""

from math import exp, log, pi

import numpy as np

from furuta.describing_functions.bristle_cycle import STEPS, bristle_fundamental
from furuta.describing_functions.describing_function import residual, residual_slopes
from furuta.transfer import Transfer
from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw
from furuta_model.friction.parameters import Friction

Zero = tuple[float, float]
Range = tuple[float, float]

# Grid points per factor e, and how often the grid may be refined.
DENSITY = 8
REFINEMENTS = 2
# Factors for the range of ω below and above the frequencies of the loop.
BELOW, ABOVE = 0.03, 10.0
# Fraction of the highest frequency below which a computed pole counts as 0.
SLOWEST = 1e-9
# Smallest arm amplitude as a fraction of the largest deflection (α₀ + α₁)/σ₀.
SMALLEST = 1e-3
# Largest arm amplitude [rad], if an undamped loop has no other bound.
LARGEST = 1e4
# A cell is skipped if its mean exceeds its variation by this factor.
MARGIN = 1.5
NEWTON_STEPS = 40
NEWTON_TOLERANCE = 1e-10


def search(g: Transfer, law: FrictionLaw) -> tuple[list[Zero], Range, Range, bool]:
    """Zeros (A, ω) [rad/s], the ranges of ω and X searched, and whether the number is right."""
    omegas = omega_range(g, law.parameters)
    deflections = deflection_range(g, law.parameters, omegas)
    for refinement in range(REFINEMENTS + 1):
        zeros, complete = _search(g, law, omegas, deflections, DENSITY * 2**refinement)
        if complete:
            break
    return zeros, omegas, deflections, complete


def omega_range(g: Transfer, p: Friction) -> Range:
    """Range of ω [rad/s], from well below to well above all frequencies of the loop."""
    mobility = g.numerator[0] / g.denominator[0]
    stuck = (p.sigma0 * mobility) ** 0.5 + (p.sigma1 + p.viscous) * mobility
    frequencies = np.abs([*g.poles, *g.real_frequencies, stuck])
    frequencies = frequencies[frequencies > SLOWEST * np.max(frequencies)]
    return BELOW * float(np.min(frequencies)), ABOVE * float(np.max(frequencies))


def deflection_range(g: Transfer, p: Friction, omegas: Range) -> Range:
    """Range of X [rad], from a linear bristle to where friction is too weak."""
    omega = np.geomspace(*omegas, 2000)
    level = p.alpha0 + p.alpha1
    strongest = 4.0 / pi * level * np.hypot(1.0, omega * p.sigma1 / p.sigma0)
    loop = np.maximum(np.abs(g.inverse_at(omega) + p.viscous) * omega, 1e-300)
    reach = level / p.sigma0
    return SMALLEST * reach, min(max(2.0 * float(np.max(strongest / loop)), reach), LARGEST)


def _search(
    g: Transfer, law: FrictionLaw, omegas: Range, deflections: Range, density: int
) -> tuple[list[Zero], bool]:
    omega, deflection = _grid(omegas, density), _grid(deflections, density)
    h = _bristle_grid(deflection, omega, law) + g.inverse_at(omega)
    zeros: list[Zero] = []
    for i, j in candidate_cells(h):
        zero = _newton(deflection[i] * omega[j], omega[j], g, law)
        if zero and _inside(zero, omegas, deflections) and _new(zero, zeros):
            zeros.append(zero)
    signs = [_index(zero, g, law) for zero in zeros]
    return zeros, sum(signs) == winding_number(h)


def _grid(ends: Range, density: int) -> np.ndarray:
    return np.geomspace(*ends, 2 + int(density * log(ends[1] / ends[0])))


@compiled
def _bristle_grid(deflection: np.ndarray, omega: np.ndarray, law: FrictionLaw) -> np.ndarray:
    """N [V s/rad] at every X of ``deflection`` (m,) and ω of ``omega`` (n,)."""
    p = law.parameters
    n = np.empty((len(deflection), len(omega)), dtype=np.complex128)
    for i in range(len(deflection)):
        for j in range(len(omega)):
            amplitude = deflection[i] * omega[j]
            z = bristle_fundamental(amplitude, omega[j], law, STEPS)
            n[i, j] = complex(p.sigma0, omega[j] * p.sigma1) * z / amplitude + p.viscous
    return n


def candidate_cells(h: np.ndarray) -> np.ndarray:
    """Cells (k, 2) of the grid of H (m, n) that may hold a zero."""
    corners = np.array([h[:-1, :-1], h[1:, :-1], h[:-1, 1:], h[1:, 1:]])
    mean = corners.mean(axis=0)
    variation = np.abs(corners - mean).max(axis=0)
    return np.argwhere(np.abs(mean) <= MARGIN * variation)


def winding_number(h: np.ndarray) -> int:
    """Revolutions of H (m, n) about zero along the edge of the grid, oriented as (A, ω)."""
    edge = np.concatenate([h[:-1, 0], h[-1, :-1], h[:0:-1, -1], h[0, :0:-1]])
    return round(float(np.sum(np.angle(np.roll(edge, -1) / edge))) / (2.0 * pi))


def _index(zero: Zero, g: Transfer, law: FrictionLaw) -> int:
    """Contribution of a zero to the winding number: sign of the Jacobian of H by (A, ω)."""
    by_amplitude, by_omega = residual_slopes(*zero, g, law)
    return int(np.sign(np.imag(np.conj(by_amplitude) * by_omega)))


def _newton(amplitude: float, omega: float, g: Transfer, law: FrictionLaw) -> Zero | None:
    """Newton's method in (log A, log ω), each step at most a factor e; None if it fails."""
    for _ in range(NEWTON_STEPS):
        h = residual(amplitude, omega, g, law)
        by_amplitude, by_omega = residual_slopes(amplitude, omega, g, law)
        columns = np.array([by_amplitude * amplitude, by_omega * omega])
        jacobian = np.array([columns.real, columns.imag])
        if abs(np.linalg.det(jacobian)) < 1e-14 * float(np.sum(np.abs(columns) ** 2)):
            return None
        step = np.clip(np.linalg.solve(jacobian, [-h.real, -h.imag]), -1.0, 1.0)
        amplitude, omega = amplitude * exp(step[0]), omega * exp(step[1])
        if np.max(np.abs(step)) < NEWTON_TOLERANCE:
            return float(amplitude), float(omega)
    return None


def _inside(zero: Zero, omegas: Range, deflections: Range) -> bool:
    amplitude, omega = zero
    return omegas[0] <= omega <= omegas[1] and deflections[0] <= amplitude / omega <= deflections[1]


def _new(zero: Zero, others: list[Zero]) -> bool:
    return not any(np.allclose(zero, other, rtol=1e-6, atol=0.0) for other in others)
