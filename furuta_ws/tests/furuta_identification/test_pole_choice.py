"""Poles that are chosen for a rig."""

import numpy as np
import pytest

from furuta_identification.result.pole_choice import quadratic_poles
from furuta_model.linear import linearize, place_poles
from furuta_model.pendulum import FurutaPendulum

SMALL = FurutaPendulum(0.006, 0.0024, 0.0019, 0.21)


@pytest.mark.parametrize(
    ("model", "viscous"), [(FurutaPendulum(), 0.0), (SMALL, 0.25), (SMALL, 0.02)]
)
def test_the_poles_are_those_of_the_optimal_loop(model: FurutaPendulum, viscous: float) -> None:
    """The stable eigenvalues of the Hamiltonian, with 2 V/rad at a drive of 10 V."""
    a, b = linearize(model, viscous)
    hamiltonian = np.block([[a, -np.outer(b, b)], [-np.diag([4.0, 0, 0, 0]), -a.T]])
    optimal = [pole for pole in np.linalg.eigvals(hamiltonian) if pole.real < 0.0]
    poles = quadratic_poles(model, viscous, 10.0)
    assert poles.polynomial == pytest.approx(np.poly(optimal).real, rel=1e-6)
    # An optimal loop stands half and any multiple of its torque.
    gain = place_poles(model, poles, viscous)
    for factor in (0.51, 1.0, 5.0):
        assert np.linalg.eigvals(a - factor * np.outer(b, gain)).real.max() < 0.0
