"""Every number of a loop and of a joint, at its ends and inside, alone and in threes.

Whatever is allowed gives a finite F̂ and u, lets the pendulum fall, or is refused in one line.
"""

from collections.abc import Iterable, Iterator
from math import isfinite, nan
from typing import Any

import numpy as np
import pytest

import furuta
from furuta_control.estimation import METHOD_NAMES
from furuta_friction.compensation import COMPENSATIONS, ObserverParameters
from furuta_friction.joint_observer import (
    JointMemory,
    ObserverNodeParameters,
    design_joint,
    joint_step,
)
from furuta_model.block import block, new_memory
from furuta_model.friction.names import LAWS
from furuta_model.parameters import Declared, ParameterError, build, declared
from furuta_model.state import LARGEST_VALUE, THETA
from furuta_sim.simulation.closed_loop import PARTS, Loop, Simulation

Values = dict[str, Any]
SECONDS = 2.0
# Parameters of which a joint's observer has other values, in units of its own.
JOINT: Values = {"joint": "elbow", "alpha0": 2.0, "alpha1": 0.2, "sigma0": 2e4, "sigma1": 50.0}
JOINT |= {"axis.inertia": 0.2, "axis.viscous": 0.3}


def numbers(group: type, prefix: str = "") -> dict[str, Declared]:
    """The declared numbers of a group by their full names."""
    return {prefix + each.name: each for each in declared(group) if each.kind in (float, int)}


OF_LOOP = {
    name: each
    for part, group in zip(PARTS, Loop(), strict=True)
    for name, each in numbers(type(group), f"{part}.").items()
    if each.name != "sample_time"
} | {"sample_time": numbers(ObserverParameters)["sample_time"]}
OF_OBSERVER = {name: OF_LOOP[name] for name in OF_LOOP if name.startswith("friction_observer.")}
OF_JOINT = numbers(ObserverNodeParameters)


def some(about: Declared, inside: int = 3) -> list[Any]:
    """The ends and some values inside, uniform in the logarithm."""
    low, high, scale = about.about.low, about.about.high, abs(float(about.default)) or 1.0
    bottom = low if np.isfinite(low) else -1e6 * scale
    top = high if np.isfinite(high) else 1e6 * scale
    series = np.geomspace(max(bottom, 1e-3 * scale, 1e-9), max(top, 1e-6), inside + 2)[1:-1]
    found = {bottom, top, *series.tolist(), *(-series if bottom < 0.0 else series).tolist()}
    kept = {float(value) for value in found if low <= value <= high}
    return sorted({round(value) for value in kept} if about.kind is int else kept)


def alone(of: dict[str, Declared]) -> Iterator[Values]:
    """Each value of each number."""
    return ({name: value} for name, about in of.items() for value in some(about))


def threes(of: dict[str, Declared], own: Iterable[str], seed: int, number: int) -> Iterator[Values]:
    """Random values of three numbers, two of them of the observer's ``own``."""
    rng, own = np.random.default_rng(seed), list(own)
    for _ in range(number):
        names = [*rng.choice(own, 2, replace=False), rng.choice(list(of))]
        yield {str(name): rng.choice(some(of[name], 5)).item() for name in names}


def fault_of_loop(given: Values) -> str:
    """What is wrong with a run; empty if nothing is."""
    try:
        run = Simulation(furuta.make_loop(given)).run(SECONDS)
    except ParameterError as error:
        return "" if "\n" not in str(error) else str(error)
    fell = not np.all(np.abs(run.state[:, THETA]) < np.pi / 2)
    for name, series in {"F̂": run.friction_estimate, "u": run.command, "x": run.state}.items():
        known = np.isfinite(series).all() and np.abs(series).max() <= LARGEST_VALUE
        if not known and not (fell and name == "x"):
            return f"{name} is {np.nanmax(np.abs(series)):.2g}, fell: {fell}"
    return ""


def fault_of_joint(given: Values) -> str:
    """The same for a joint that follows a slow sine under a PD controller."""
    try:
        p = build(ObserverNodeParameters, JOINT | given)
        memory, design = new_memory(JointMemory), block(design_joint(p))
    except ParameterError as error:
        return "" if "\n" not in str(error) else str(error)
    q = v = torque = 0.0
    for k in range(400):
        reference = 0.3 * np.sin(0.02 * k)
        samples = 0 if k in (0, 250) else 1 + k % 3 // 2
        friction = joint_step(memory, (q, v, torque, nan), design, samples)
        if not isfinite(friction):
            return f"F̂ is {friction:.3g} in sample {k}"
        torque = float(np.clip(20.0 * (reference - q) - 2.0 * v + friction, -50.0, 50.0))
        v += 1e-3 * (torque - float(np.clip(torque + v / 1e-3 * 0.2, -2.0, 2.0))) / 0.2
        q += 1e-3 * v
    return ""


def faults(fault_of: Any, base: Values, cases: Iterable[Values]) -> list[str]:
    """The cases at fault, each with what is wrong."""
    return [f"{case}: {fault}" for case in cases if (fault := fault_of(base | case))]


@pytest.mark.parametrize("compensation", COMPENSATIONS)
def test_each_number_of_a_loop(compensation: str) -> None:
    base = {"friction_observer.compensation": compensation}
    assert not faults(fault_of_loop, base, alone(OF_LOOP))
    assert not faults(fault_of_loop, base, threes(OF_LOOP, OF_OBSERVER, 1, 100))


@pytest.mark.parametrize("compensation", COMPENSATIONS)
def test_each_number_of_a_joint(compensation: str) -> None:
    base = {"compensation": compensation}
    assert not faults(fault_of_joint, base, alone(OF_JOINT))
    assert not faults(fault_of_joint, base, threes(OF_JOINT, OF_JOINT, 2, 100))


@pytest.mark.long
@pytest.mark.parametrize("compensation", COMPENSATIONS)
def test_every_law_method_and_mode(compensation: str) -> None:
    """Each number alone and a thousand threes, with random laws and parts."""
    rng, cases = np.random.default_rng(3), threes(OF_LOOP, OF_OBSERVER, 4, 1000)
    base = {"friction_observer.compensation": compensation}

    def drawn() -> Values:
        law, method = rng.choice(LAWS), rng.choice(METHOD_NAMES)
        mode = rng.choice(["balance", "swing_up", "open_loop"])
        parts = {"plant.friction.law": law, "method": method, "mode": mode}
        return {name: str(part) for name, part in parts.items()}

    found = [*alone(OF_LOOP), *cases]
    assert not faults(fault_of_loop, base, ({**drawn(), **case} for case in found))
