"""Comparison of friction laws: the data support no law that the arm does not have."""

import numpy as np
import pytest

from furuta.identification.fitting.friction_laws import (
    LawResult,
    compare_laws,
    simplest_adequate_law,
)
from furuta.identification.model import Model
from furuta.identification.shooting.prediction import move
from furuta.identification.shooting.unknowns import BODY, ParameterValues
from furuta_model.parameters import ParameterError
from furuta_model.pendulum import FurutaPendulum
from furuta_recordings.recording import Recording

INTERVAL, STEPS = 0.004, 8  # [s] between samples, and steps of the simulation in it
SECONDS = 8.0
# Noise of the readings [rad, rad/s, rad, rad/s]: a law counts only by what exceeds it.
NOISE = np.array((2e-4, 0.02, 2e-4, 0.02))
FITTED = [*BODY, "viscous", "coulomb", "pendulum_viscous"]


def paper_arm(**friction: float) -> ParameterValues:
    """The paper's pendulum on an arm with the given friction."""
    p = FurutaPendulum()
    rest = {"viscous": 0.03, "coulomb": 0.15, "pendulum_viscous": 1e-4} | friction
    inertia = p.alpha - p.gamma**2 / p.beta
    return ParameterValues.of(
        arm_inertia=inertia, beta=p.beta, gamma=p.gamma, delta=p.delta, **rest
    )


def swung(arm: ParameterValues) -> Recording:
    """A pendulum that swings from hanging while the command jumps between two levels."""
    r = np.random.default_rng(1)
    time = INTERVAL * np.arange(round(SECONDS / INTERVAL))
    levels = r.choice((-0.8, -0.5, 0.5, 0.8), 100)
    command = levels[(time / 0.4).astype(int)]
    x, rows = np.array((0.0, 0.0, np.pi, 0.0, 0.0)), []
    for u in command:
        rows.append(x[:4].copy())
        move(x, u, INTERVAL, STEPS, arm.model)
    measured = np.array(rows) + r.normal(0.0, NOISE, (len(rows), 4))
    return Recording("swung", time, measured, time, command)


def model_of(values: ParameterValues, recording: Recording) -> Model:
    """A model with these values, fitted to this recording as far as the laws can see."""
    size = len(FITTED)
    matrices = np.zeros((size, size)), np.eye(size)
    return Model(values, FITTED, *matrices, np.inf, 10.0 * NOISE, [recording], [])


def compared(truth: ParameterValues, *laws: str) -> list[LawResult]:
    """Results of Coulomb's law and others for an arm that a model without them describes."""
    start = truth.changed(["asymmetry", "alpha1"], (0.0, 0.0))
    return compare_laws(model_of(start, swung(truth)), laws=("coulomb", *laws))


def test_without_dry_friction_nothing_is_predicted() -> None:
    coulomb, viscous = compared(paper_arm(), "viscous")
    assert coulomb.errors == {"first half": 1.0, "second half": 1.0}
    assert viscous.parameters == coulomb.parameters - 1
    assert min(viscous.errors.values()) > 10.0


@pytest.mark.parametrize(
    ("friction", "law"),
    [
        ({}, "coulomb"),
        pytest.param({"asymmetry": 0.2}, "asymmetric", marks=pytest.mark.long),
        pytest.param({"sigma0": 30.0, "sigma1": 0.5}, "lugre", marks=pytest.mark.long),
    ],
)
def test_the_law_of_the_arm_is_found(friction: dict[str, float], law: str) -> None:
    results = compared(paper_arm(**friction), "asymmetric", "lugre")
    assert simplest_adequate_law(results).law == law


def test_an_arm_that_never_reverses_tells_no_law() -> None:
    one = swung(paper_arm())
    turning = one._replace(measured=np.abs(one.measured))
    with pytest.raises(ParameterError, match="need reversals of the arm"):
        compare_laws(model_of(paper_arm(), turning))
