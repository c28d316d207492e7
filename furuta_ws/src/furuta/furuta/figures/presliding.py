"""Presliding of LuGre, Dahl and Maxwell slip: memory of reversals, and drift of a loaded arm."""

import itertools
from pathlib import Path

import numpy as np

from furuta.figures.figure import FAINT_GRID, saved_figure, style_axis
from furuta_model.block import new_memory
from furuta_model.friction.laws import bristle_force, friction_law
from furuta_model.friction.maxwell_slip import MAX_SPRINGS
from furuta_model.friction.parameters import Friction
from furuta_model.parts.converter import Actuator
from furuta_model.parts.motion import PendulumFriction
from furuta_model.parts.plant_memory import PlantMemory
from furuta_model.parts.springs import keep_springs, springs_force, springs_friction
from furuta_model.state import PHI, THETA
from furuta_sim.parameters import PlantFriction, PlantParameters
from furuta_sim.plant import design_plant, initial_plant, move

LAWS = ("lugre", "dahl", "maxwell_slip")
COLOURS = {"lugre": "tab:green", "dahl": "tab:orange", "maxwell_slip": "tab:blue"}
# Corners of the arm's path, in units of g/σ₀: a loop between the second and the fourth.
CORNERS = (0.0, 1.5, -0.5, 0.3, -0.5, -2.5)
# Mean and amplitude of the torque on the loaded arm, relative to the level; period and time [s].
MEAN, AMPLITUDE, PERIOD, TIME = 0.5, 0.2, 1.0, 20.0


def draw_presliding(p: Friction, path: Path) -> None:
    """Draw friction over a path with an inner loop, and the angle of an arm below its level."""
    with saved_figure(path, 1, 2, figsize=(12, 4.6)) as (_, (loops, drifts)):
        for name in LAWS:
            angle, force = inner_loop(name, p)
            loops.plot(1e3 * angle, force, color=COLOURS[name], lw=1.4, label=name)
            time, angle = loaded_arm(name, p)
            drifts.plot(time, 1e3 * angle, color=COLOURS[name], lw=1.0, label=name)
        style_axis(loops, "arm angle [mrad]", "friction F [V]", FAINT_GRID)
        loops.set_title("a path with a small loop inside a larger one")
        style_axis(drifts, "time [s]", "arm angle [mrad]", FAINT_GRID)
        drifts.set_title(f"torque {MEAN - AMPLITUDE:.1g} to {MEAN + AMPLITUDE:.1g} of the level")
        loops.legend(loc="lower right")
        drifts.legend(loc="upper left")


def inner_loop(name: str, p: Friction, steps: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Angle [rad] and friction [V] of an arm that is moved slowly along :data:`CORNERS`."""
    reach = (p.alpha0 + p.alpha1) / p.sigma0
    parts = itertools.pairwise(CORNERS)
    angle = reach * np.concatenate([np.linspace(a, b, steps, endpoint=False) for a, b in parts])
    return angle, np.array(_prescribed(name, p, angle))


def _prescribed(name: str, p: Friction, angle: np.ndarray) -> list[float]:
    """Friction [V] at every angle of a slow path, without viscous part."""
    law = friction_law(name, p._replace(sigma1=0.0))
    memory, z, force = new_memory(PlantMemory)[0], 0.0, [0.0]
    for v in np.diff(angle):
        if law.law.springs:
            springs_force(memory, v, 1.0, MAX_SPRINGS, law)
            keep_springs(memory, MAX_SPRINGS)
            force.append(springs_friction(memory, v, MAX_SPRINGS, law))
        else:
            _, z = bristle_force(v, z, 1.0, law)
            force.append(p.sigma0 * z)
    return force


def loaded_arm(name: str, p: Friction) -> tuple[np.ndarray, np.ndarray]:
    """Time [s] and angle [rad] of an arm under an oscillating torque below the level.

    The pendulum hangs and is damped.
    """
    plant = PlantParameters(
        friction=PlantFriction(name, p, MAX_SPRINGS),
        actuator=Actuator(bits=0),
        pendulum_friction=PendulumFriction(damping=0.02),
    )
    design, memory = design_plant(plant), initial_plant(plant)[0]
    x = memory["x"]
    x[THETA] = np.pi
    time = np.arange(round(TIME / plant.sample_time)) * plant.sample_time
    wave = AMPLITUDE * np.sin(2.0 * np.pi * time / PERIOD) * (time > PERIOD)
    torque = p.alpha0 * (MEAN * np.minimum(time / PERIOD, 1.0) + wave)
    angle = np.empty(len(time))
    for k, u in enumerate(torque):
        move(memory, u, design)
        angle[k] = x[PHI]
    return time, angle
