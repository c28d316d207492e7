"""Describing functions, compared with quadrature and with integration in time."""

import numpy as np
import pytest
import reference
from scipy.integrate import quad, solve_ivp

from furuta.describing_functions.describing_function import bias, describing_function
from furuta_model.friction.laws import friction_law, steady_friction
from furuta_model.friction.parameters import Friction

UNEQUAL = Friction(viscous=0.3, asymmetry=0.25)
DAMPED = Friction(viscous=0.3, sigma1=0.2, alpha1=0.1)


def fundamental(force: np.ndarray, phase: np.ndarray, amplitude: float) -> complex:
    """N from samples of the force over full periods of v = A sin(phase)."""
    return complex(2j * np.mean(force * np.exp(-1j * phase)) / amplitude)


def simulated(amplitude: float, omega: float, p: Friction) -> complex:
    """LuGre's N from equation (5) integrated in time over one period.

    z after a period is linear in z before, so two integrations give the periodic solution.
    """

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        v = amplitude * np.sin(omega * t)
        return v - p.sigma0 * abs(v) / reference.level(v, p) * z

    def period(start: float, phase: np.ndarray) -> np.ndarray:
        return solve_ivp(
            rate,
            (0, 2 * np.pi / omega),
            [start],
            method="Radau",
            t_eval=phase / omega,
            rtol=1e-9,
            atol=1e-14,
            max_step=0.02 / omega,
        ).y[0]

    turn = np.array([2 * np.pi])
    end, shifted = period(0.0, turn)[0], period(1e-3, turn)[0]
    samples = 20_000
    phase = 2 * np.pi * (np.arange(samples) + 0.5) / samples
    z = period(end / (1.0 - (shifted - end) / 1e-3), phase)
    v = amplitude * np.sin(phase)
    z_dot = v - p.sigma0 * np.abs(v) / np.array([reference.level(speed, p) for speed in v]) * z
    force = p.sigma0 * z + p.sigma1 * z_dot + p.viscous * v
    return fundamental(force, phase, amplitude)


@pytest.mark.parametrize("kind", ["coulomb", "stiction", "stribeck"])
@pytest.mark.parametrize("amplitude", [0.04, 10.0])
def test_static_laws_by_quadrature(kind: str, amplitude: float) -> None:
    law = friction_law(kind, UNEQUAL)

    def coefficient(weight: object) -> float:
        quarters = (
            quad(
                lambda x: steady_friction(amplitude * np.sin(x), law) * weight(x),  # type: ignore
                0.5 * k * np.pi,
                0.5 * (k + 1) * np.pi,
                points=(0.5 * k * np.pi + 1e-3, 0.5 * (k + 1) * np.pi - 1e-3),
                limit=500,
                epsabs=1e-12,
            )[0]
            for k in range(4)
        )
        return sum(quarters) / np.pi / amplitude

    n = describing_function(amplitude, 3.0, law)
    assert n.imag == 0.0
    assert n.real == pytest.approx(coefficient(np.sin), rel=1e-7)
    assert coefficient(np.cos) == pytest.approx(0.0, abs=1e-7 * n.real)
    assert bias(amplitude, law) == pytest.approx(
        0.5 * amplitude * coefficient(lambda _: 1.0), abs=1e-9
    )


@pytest.mark.parametrize(
    ("amplitude", "omega", "p"),
    [(1e-3, 30.0, DAMPED), (0.05, 1.0, Friction()), (2.0, 1.0, DAMPED)],
)
def test_lugre_by_integration_in_time(amplitude: float, omega: float, p: Friction) -> None:
    n = describing_function(amplitude, omega, friction_law("lugre", p))
    assert n == pytest.approx(simulated(amplitude, omega, p), rel=2e-6)
