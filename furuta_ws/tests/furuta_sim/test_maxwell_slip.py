"""The Maxwell-slip law: virgin curve, non-local memory, no drift in presliding."""

import numpy as np
import pytest
from plant_steps import PlantSteps

from furuta_model.block import new_memory
from furuta_model.compiled import compiled
from furuta_model.friction.laws import FrictionLaw, friction_law
from furuta_model.friction.maxwell_slip import MAX_SPRINGS
from furuta_model.friction.parameters import Friction
from furuta_model.parts.motion import PendulumFriction
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.parts.varied_friction import joint_friction, keep_springs, presliding_force
from furuta_model.sensors import Actuator
from furuta_sim.parameters import PlantFriction, PlantParameters

P = Friction(alpha1=0.0)
REACH = P.alpha0 / P.sigma0


@compiled
def _follow(x: PlantMemory, path: np.ndarray, springs: int, law: FrictionLaw) -> np.ndarray:
    force = np.empty(len(path))
    before = 0.0
    for k in range(len(path)):
        v = (path[k] - before) / 1e-3
        before = path[k]
        presliding_force(x, v, 0.0, 1e-3, springs, law)
        keep_springs(x, springs)
        force[k] = joint_friction(x, v, 0.0, springs, law)
    return force


def follow(corners: list[float], springs: int, steps: int = 200) -> np.ndarray:
    """Friction [V] at each of the ``corners`` of the arm's path, in units of g/σ₀, from slack."""
    path = np.concatenate(
        [np.linspace(a, b, steps + 1)[1:] for a, b in zip([0.0, *corners], corners, strict=False)]
    )
    law = friction_law("maxwell_slip", P)
    return _follow(new_memory(PlantMemory)[0], path * REACH, springs, law)[steps - 1 :: steps]


@pytest.mark.parametrize("springs", [1, 2, MAX_SPRINGS])
def test_virgin_curve(springs: int) -> None:
    """It begins with σ₀, lies within g/(4N²) of the parabola, and saturates at g."""
    assert follow([1e-3], springs)[0] == pytest.approx(P.sigma0 * 1e-3 * REACH)
    for x in np.linspace(0.05, 2.0, 40):
        parabola = P.alpha0 * (x - 0.25 * x * x)
        assert -1e-12 < follow([x], springs)[0] - parabola < P.alpha0 * (0.25 / springs**2 + 1e-12)
    assert follow([3.0], springs)[0] == pytest.approx(P.alpha0)


def test_memory_of_reversals() -> None:
    """A closed inner loop leaves no trace, and the outer branch continues as if without it."""
    before, _, after, outer = follow([1.2, 0.5, 1.2, 1.5], 8)
    assert after == pytest.approx(before, rel=1e-12)
    assert outer == pytest.approx(follow([1.5], 8)[0], rel=1e-12)
    # Two pasts with the same force and position, but another inner loop, differ in the future.
    first = follow([1.2, -0.4, 0.3], 8)
    second = follow([1.2, -0.4, 0.6, 0.0, 0.3], 8)
    assert abs(first[-1] - second[-1]) > 1e-3


def arm_under(law: str, torque: np.ndarray) -> np.ndarray:
    """Angle [rad] of the arm below a hanging pendulum under a torque [V] for each sample."""
    parameters = PlantParameters(
        friction=PlantFriction(law, P, 8),
        actuator=Actuator(bits=0),
        pendulum_friction=PendulumFriction(damping=0.02),
    )
    plant = PlantSteps(parameters)
    x = plant.memory["x"][0]
    x[2] = np.pi
    angle = np.empty(len(torque))
    for k, u in enumerate(torque):
        plant.move(u)
        angle[k] = x[0]
    return angle


def test_no_drift_under_a_small_oscillating_torque() -> None:
    """Between 0.3 and 0.7 of the level LuGre and Dahl creep on; the springs do not."""
    time = np.arange(40_000) * 1e-3
    ramp = np.minimum(time, 1.0)
    torque = P.alpha0 * (0.5 * ramp + 0.2 * np.sin(2.0 * np.pi * time) * (time > 1.0))
    drift = {
        law: angle[-1] - angle[20_000 - 1]
        for law in ("lugre", "dahl", "maxwell_slip")
        for angle in [arm_under(law, torque)]
    }
    assert drift["lugre"] > 1e-3
    assert drift["dahl"] > 1e-3
    # The pendulum, which the torque swings, has not quite come to rest.
    assert abs(drift["maxwell_slip"]) < 5e-6
