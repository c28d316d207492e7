"""Campaign ``plant``: the simulated plant with random states and commands, by direct calls.

Its energy must not grow without drive, whatever friction law it has, and commands that are refused
must not move it.
"""

import os
from math import pi

import numpy as np
from rclpy.parameter import Parameter

from furuta_model.friction.laws import LAWS
from furuta_ros.context import ros_context
from furuta_sim.plant_node import PlantNode
from soak.mutators import pick, random_float
from soak.oracles import different_value, energy_growth, out_of_bounds, wrong_refusal
from soak.record import Record
from soak.resources import ResourceMonitor
from soak.subject import Subject

SAMPLES = 3000
# Samples from one push to the next, and of a push: longer ones make it faster than any rig.
STRETCH, PUSH = 500, 30
# Largest initial speeds [rad/s].
FASTEST = 15.0
# N springs of Maxwell slip store 4/3 - 1/(3N²) of the energy of one bristle.
SPRING_STORAGE = 4.0 / 3.0


def run(record: Record, watch: ResourceMonitor) -> None:
    """Run the slice."""
    random = record.part.random()
    with ros_context():
        while record.next_step():
            subject = Subject(lambda: _plant(random))
            _refuse(record, random, subject)
            _move(record, random, subject.node)
            subject.node.destroy_node()
            watch.sample({"plant by direct calls": os.getpid()})


def _plant(random: np.random.Generator) -> PlantNode:
    law = str(pick(random, LAWS))
    speeds = random.uniform(-FASTEST, FASTEST, 2)
    initial = {"phi_dot": speeds[0], "theta_dot": speeds[1], "theta": random.uniform(-pi, pi)}
    given = [Parameter(f"initial.{name}", value=float(v)) for name, v in initial.items()]
    clock = Parameter("clock", value="lockstep")
    return PlantNode([*given, clock, Parameter("friction.law", value=law)])


def _refuse(record: Record, random: np.random.Generator, subject: Subject) -> None:
    """Commands outside a sample: none moves the plant; NaN and infinity are refused."""
    before = subject.node.x.tolist()
    for _ in range(20):
        given = random_float(random)
        refused, _ = subject.give("command", given.message)
        record.check("refusal", wrong_refusal(given.refuse, refused, given.message.data))
    record.check("unchanged", different_value(subject.node.x.tolist(), before))


def _move(record: Record, random: np.random.Generator, plant: PlantNode) -> None:
    """Stretches with and without drive."""
    states, volts = [], []
    u = 0.0
    for k in range(SAMPLES):
        if k % STRETCH == 0:
            u = float(pick(random, (0.0, random.normal(0, 5), 1e300)))
        elif k % STRETCH == PUSH:
            u = 0.0
        states.append(plant.x[:4].copy())
        volts.append(u)
        plant.held = False
        plant.move(u)
    x = np.array(states)
    rig = plant.parameters.plant
    storage = SPRING_STORAGE if rig.friction.law == "maxwell_slip" else 1.0
    growth = energy_growth(x, np.array(volts), rig.model, rig.friction.parameters, storage)
    record.check("energy", growth)
    # An open loop without viscous friction may turn the arm as far as it likes.
    x[:, 0] = np.where(np.isfinite(x[:, 0]), 0.0, np.nan)
    record.check("bounds", out_of_bounds(x))
