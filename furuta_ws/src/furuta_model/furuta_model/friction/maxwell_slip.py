r"""Maxwell slip: N springs side by side, each of which slips at its own level.

The arm stretches every spring by its own motion. Spring i slips at

.. math:: |z_i| = \frac{2i - 1}{N} \frac{g(v)}{σ_0}, \qquad i = 1 … N

All springs have the stiffness σ₀/N. From rest friction therefore begins with the stiffness σ₀ and
saturates at g(v), the Stribeck curve. In between it is a polygon, within g/(4N²) of the parabola
g(x - x²/4), x = σ₀z/g(v). There is no damping σ₁:

.. math:: F = \frac{σ_0}{N} \sum_i z_i + σ_2 v

The springs remember every reversal that no larger one has wiped out (non-local memory), and a
small oscillating force does not move the arm on. F. Al-Bender, V. Lampaert, J. Swevers, *The
generalized Maxwell-slip model*, IEEE Transactions on Automatic Control 50(11), 2005; here a spring
that slips is at its level at once (their attraction parameter C is infinite).

At constant speed a spring stretches linearly until it slips, so each step is exact.
"""

from furuta_model.compiled import compiled
from furuta_model.friction.parameters import SMALLEST_LEVEL, Friction

# Largest number of springs.
MAX_SPRINGS = 8


@compiled
def slip_deflection(spring: int, springs: int, level: float, p: Friction) -> float:
    """Deflection [rad] at which a spring, 0 to ``springs`` - 1, slips; ``level`` is g(v) [V]."""
    return (2.0 * spring + 1.0) / springs * max(level, SMALLEST_LEVEL) / p.sigma0


@compiled
def stretched(z: float, path: float, slip: float) -> tuple[float, float]:
    """Stretch a spring at deflection ``z`` [rad] by ``path`` [rad], covered at constant speed.

    Returns its deflection at the end and the mean deflection over the path [rad]. ``slip`` is the
    deflection at which it slips in this direction. A spring beyond it, because the level has
    fallen, slips at once.
    """
    if path == 0.0:
        return z, z
    direction = 1.0 if path > 0.0 else -1.0
    length = direction * path
    start = min(direction * z, slip)
    held = min(length, slip - start)
    mean = start + held * (1.0 - 0.5 * held / length)
    return direction * (start + held), direction * mean
