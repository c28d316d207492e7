r"""Limit cycles that the describing function predicts for any linear loop with a friction joint.

G(s) from the force on the joint to its speed is B/D with the polynomials

.. math::
    D(s) = \det(sI - A), \qquad B(s) = \det(sI - A + b c) - D(s)
"""

from __future__ import annotations

import numpy as np

from furuta.describing_functions.predicted_cycles import PredictedCycle, Prediction, predict_cycles
from furuta.limit_cycles.joint import Joint, Units
from furuta.limit_cycles.linear_loop import LinearLoop
from furuta.transfer import Transfer

REAL = 1e-7  # relative imaginary part of a computed root that is real


class JointTransfer(Transfer):
    """G(s) of a scaled loop: coefficients of B and D, highest power first."""

    @property
    def real_frequencies(self) -> tuple[float, ...]:
        """All ω > 0 at which G(jω) is real: roots of Im(D(jω) B(−jω))."""
        b, d = (
            np.array(part) * 1j ** np.arange(len(part) - 1, -1, -1)
            for part in (self.numerator, self.denominator)
        )
        roots = np.roots(np.polymul(d, b.conj()).imag)
        real = roots[(np.abs(roots.imag) < REAL * np.abs(roots)) & (roots.real > 0.0)].real
        return tuple(sorted(real.tolist()))


def joint_transfer(loop: LinearLoop) -> JointTransfer:
    """G(s) of the loop, whose first state is the speed."""
    fed_back = loop.a.copy()
    fed_back[:, 0] -= loop.b
    denominator = np.poly(loop.a)
    numerator = (np.poly(fed_back) - denominator)[1:]
    return JointTransfer(tuple(numerator.tolist()), tuple(denominator.tolist()))


def predict_joint(given: Joint) -> Prediction:
    """All solutions of 1 + G(jω)N(A, ω) = 0 with ω > 0, in the user's units."""
    scaled, units = predict_cycles(joint_transfer(given.loop), given.loop.law), given.units
    low, high = scaled.omega_range_rad_s
    least, largest = scaled.phi_amplitude_range_rad
    return scaled._replace(
        cycles=tuple(_in_units(cycle, units) for cycle in scaled.cycles),
        omega_range_rad_s=(low / units.time, high / units.time),
        phi_amplitude_range_rad=(least * units.position, largest * units.position),
    )


def _in_units(cycle: PredictedCycle, units: Units) -> PredictedCycle:
    return PredictedCycle(
        cycle.omega_rad_s / units.time,
        cycle.velocity_amplitude_rad_s * units.speed,
        cycle.phi_peak_to_peak_rad * units.position,
        cycle.period_s * units.time,
        cycle.stable,
        cycle.bias_v * units.force,
    )
