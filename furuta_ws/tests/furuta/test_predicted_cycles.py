"""Predicted limit cycles: residuals, completeness, stability, and the simulated motion."""

import control
import numpy as np
import pytest

import furuta
from furuta.describing_functions.describing_function import residual, static_describing_function
from furuta.describing_functions.predicted_cycles import predict_cycles
from furuta.loops import ideal_loop
from furuta.transfer import FIGURE_4, transfer
from furuta_model.friction.laws import ANALYSED_LAWS, friction_law
from furuta_model.friction.parameters import Friction
from furuta_model.linear import DesiredPoles, place_poles
from furuta_model.pendulum import FurutaPendulum

P = FurutaPendulum()
PLACED = -place_poles(P, DesiredPoles())


@pytest.mark.parametrize("kind", ["coulomb", "stribeck", "lugre"])
@pytest.mark.parametrize("feedback", [tuple(PLACED), *FIGURE_4.values()])
def test_every_cycle_balances(kind: str, feedback: tuple[float, ...]) -> None:
    """1 + GN vanishes at each predicted cycle; there is one if φ is fed back, else none."""
    g, law = transfer(P, feedback), friction_law(kind)
    prediction = predict_cycles(g, law)
    assert prediction.complete
    assert len(prediction.cycles) == (feedback[0] != 0.0)
    for cycle in prediction.cycles:
        assert cycle.stable
        h = residual(cycle.velocity_amplitude_rad_s, cycle.omega_rad_s, g, law)
        assert abs(h) < 1e-9 * abs(complex(g.inverse_at(cycle.omega_rad_s)))


def test_several_cycles() -> None:
    """On a bristle without damping an unstable cycle separates rest from a stable one."""
    g = transfer(P, (26.405, 3.6467, 58.786, 6.479))
    p = Friction(alpha1=0.0, sigma0=25.906, sigma1=0.0)
    cycles = predict_cycles(g, friction_law("lugre", p)).cycles
    assert [cycle.stable for cycle in cycles] == [False, True]


def test_stability_agrees_with_the_poles() -> None:
    """A cycle is stable if the loop with N at a larger amplitude has only stable poles."""
    rng = np.random.default_rng(8)
    law = friction_law("coulomb")
    verdicts = []
    for feedback in rng.normal([5, 3, 40, 8], [10, 4, 30, 10], (200, 4)):
        g = transfer(P, feedback)
        for cycle in predict_cycles(g, law).cycles:
            n = static_describing_function(1.001 * cycle.velocity_amplitude_rad_s, law)
            poles = np.roots(np.polyadd(g.denominator, n * np.array(g.numerator)))
            assert cycle.stable == bool(np.all(poles.real < 0.0))
            verdicts.append(cycle.stable)
    assert verdicts.count(True) > 20
    assert verdicts.count(False) > 20


def test_frictionless_and_viscous_loops_have_none() -> None:
    """No cycle without friction, or with viscous friction beyond 1/|G| at the crossing."""
    g = transfer(P, PLACED)
    for kind in ANALYSED_LAWS:
        assert predict_cycles(g, friction_law(kind, Friction(alpha0=0.0, alpha1=0.0))).cycles == ()
        viscous = 1.0 / abs(g.crossings[0].real)
        (cycle,) = predict_cycles(g, friction_law(kind, Friction(viscous=0.5 * viscous))).cycles
        assert cycle.phi_peak_to_peak_rad > 0.9
        assert predict_cycles(g, friction_law(kind, Friction(viscous=1.05 * viscous))).cycles == ()


@pytest.mark.parametrize("law", ["coulomb", "stribeck", "lugre"])
def test_python_control_finds_the_predicted_cycle(law: str) -> None:
    """From G and friction as its objects, also with viscous friction; near the exact cycle."""
    ideal = ideal_loop(furuta.make_loop({"plant.friction.viscous": 0.02}), law=law)
    (predicted,) = furuta.predict_cycles(ideal).cycles
    friction = furuta.friction_nonlinearity(ideal.law, predicted.omega_rad_s)
    assert isinstance(friction, control.DescribingFunctionNonlinearity)
    g = furuta.linearize(ideal)["phi_dot", "torque"]
    omega, amplitudes = np.geomspace(1.0, 10.0, 50), np.linspace(0.3, 3.0, 20)
    ((amplitude, at),) = control.describing_function_response(g, friction, amplitudes, omega)
    assert amplitude == pytest.approx(predicted.velocity_amplitude_rad_s, rel=1e-4)
    assert at == pytest.approx(predicted.omega_rad_s, rel=1e-4)
    exact = furuta.limit_cycle(ideal)
    assert 2.0 * amplitude / at == pytest.approx(exact.phi_peak_to_peak_rad, rel=0.3)
    assert 2.0 * np.pi / at == pytest.approx(exact.period_s, rel=0.15)


def test_friction_as_an_object_of_python_control() -> None:
    """Force without the viscous part, its N also by their integral; bad frequencies are refused."""
    law = furuta.friction_law("stribeck", furuta.Friction(alpha0=0.3, alpha1=0.1, viscous=0.5))
    friction = furuta.friction_nonlinearity(law)
    assert [friction(v) for v in (-1e6, 0.0, 1e6)] == pytest.approx([-0.3, 0.0, 0.3])
    (theirs,) = control.describing_function(friction, [2.0], num_points=10_000, try_method=False)
    assert theirs == pytest.approx(friction.describing_function(2.0), rel=1e-3)
    for omega in (None, 0.0, -1.0):
        with pytest.raises(furuta.ParameterError, match="lugre needs omega"):
            furuta.friction_nonlinearity(furuta.friction_law("lugre"), omega)
    with pytest.raises(furuta.ParameterError, match="not defined for the friction law maxwell"):
        furuta.friction_nonlinearity(furuta.friction_law("maxwell_slip"), 1.0)
