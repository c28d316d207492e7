"""What cannot be is refused by each function, in one line that says why or what is allowed."""

from collections.abc import Callable
from math import nan
from typing import Any

import control
import numpy as np
import pytest

import furuta
from furuta.axis.compensations import compare_on_axis
from furuta.axis.friction_text import friction_from_text
from furuta.describing_functions.describing_function import describing_function
from furuta.limit_cycles.continuation import Branch
from furuta.limit_cycles.limit_cycle import limit_cycle
from furuta.limit_cycles.pendulum_loop import IdealLoop
from furuta.limit_cycles.periodic_orbit import LimitCycle
from furuta.loops import ideal_loop
from furuta.margins import margins
from furuta.settings.settings import default_settings, load_settings
from furuta.studies.comparison.candidates import parse_candidates
from furuta.studies.sweep import Sweep, SweptParameter, parse_swept_parameter
from furuta.transfer import transfer
from furuta_control.control import ControllerParameters
from furuta_friction.joint_observer import ObserverNodeParameters
from furuta_model.friction.laws import FrictionLaw, analysed_law
from furuta_model.parameters import build
from furuta_sim.parameters import PlantParameters

BODY, LAW = furuta.FurutaPendulum(), FrictionLaw()
A, B, C = np.array([[-1.0, 4.0], [-1.0, 0.0]]), np.array([[1.0], [0.0]]), np.array([[1.0, 0.0]])
AXIS, PID = furuta.Axis(0.01, furuta.Friction(alpha0=0.1, alpha1=0.1)), furuta.Pid(1.0, 2.0, 0.08)
RECORDING = furuta.Recording("mine", *(np.zeros(shape) for shape in (3, (3, 4), 3, 2)))
ALPHA0 = SweptParameter("alpha0", (1.0, 2.0))


def joint(system: Any = (A, B, C)) -> Any:
    """A linear loop with friction."""
    return furuta.friction_joint(system, AXIS.friction, "stiction")


def cycle_of(gamma: float, *gains: float, asymmetry: float = 0.0) -> object:
    """The limit cycle of an ideal loop."""
    law = furuta.friction_law("lugre", furuta.Friction(asymmetry=asymmetry))
    return limit_cycle(IdealLoop(BODY._replace(gamma=gamma), law, *gains))


def plant(**given: Any) -> object:
    """A plant; ``__`` in a name stands for a dot."""
    return build(PlantParameters, {name.replace("__", "."): each for name, each in given.items()})


def controller(**given: Any) -> object:
    return build(ControllerParameters, given)


def candidate(text: str) -> object:
    return parse_candidates([text], default_settings())


def named_rigs(**given: Any) -> object:
    return furuta.compare(rigs="named", seconds=5.0, **given)


def swept(*axes: SweptParameter) -> int:
    return Sweep({"plant": {"seed": 1}}, axes, 60.0).size()


# Each reason, and a call that is refused for it.
REFUSED: dict[str, Callable[[], object]] = {
    # Loops, rigs and settings.
    r"gamma must be at least 1e-09 V s²/rad, given 0$": lambda: furuta.place_poles(
        furuta.FurutaPendulum(gamma=0), furuta.DesiredPoles()
    ),
    r"above 0 and at most 1e\+06, given 1e\+300": lambda: furuta.simulate(seconds=1e300),
    "settled must be above 0 and at most 1, given 0": lambda: furuta.measure(settled=0.0),
    "needs at least 56 s of pendulum time, given 1": lambda: furuta.tune(seconds=1.0),
    "no rig nobody; rigs are": lambda: furuta.make_loop(rig="nobody"),
    "parameter alfa0; did you mean alpha0": lambda: furuta.make_loop({"alfa0": 0.1}),
    "disturbances are delay, lag, noise": lambda: furuta.random_rigs(disturbances=["x"]),
    r"command must have shape \(3,\), given \(2,\)": lambda: furuta.identify(RECORDING),
    "expected NAME=VALUE, given 'alpha0'": lambda: load_settings([], ["alpha0"]),
    "no parameter alfa0; did you mean alpha0": lambda: load_settings([], ["alfa0=1"]),
    "alpha0 must be a number, given None": lambda: load_settings([], ["alpha0="]),
    "times 3, arm 2": lambda: plant(pushes__times=[1.0, 2.0, 3.0], pushes__arm=[1.0, 2.0]),
    "encoder, tachometer, potentiometer": lambda: plant(sensor_faults__stuck="camera"),
    "backlash needs coupling.frequency above 0": lambda: plant(coupling__backlash=0.01),
    "no filter for inertia 1e-300": lambda: build(
        ObserverNodeParameters, {"joint": "elbow", "axis.inertia": 1e-300}
    ),
    "alpha0 of the arm must be at most 100, given 150": lambda: build(
        ObserverNodeParameters, {"alpha0": 150.0}
    ),
    r"four numbers .* given \[1.0, 2.0, 3.0\]": lambda: controller(gain=[1.0, 2.0, 3.0]),
    "gain must be finite, given nan": lambda: controller(gain=[1.0, 2.0, 3.0, nan]),
    "gain must be a list of numbers, given '1234'": lambda: controller(gain="1234"),
    r"alpha \* beta must exceed .* gamma = 0\.0204": lambda: build(
        ControllerParameters, {"model.gamma": 0.0204}
    ),
    r"must not exceed fall_angle, given 0\.8 > 0\.7": lambda: controller(catch_angle=0.8),
    "mode swing_up needs a feedback that catches": lambda: controller(
        mode="swing_up", voltage_limit=0.0
    ),
    # Analysis.
    "does not stabilise": lambda: furuta.limit_cycle(feedback=[-7.69, -1.36, -1.05, -0.504]),
    "level of a direction too small": lambda: cycle_of(0.02, 1, 1, 1, 1, asymmetry=1.0 - 1e-9),
    "alpha.* gamma = 1": lambda: cycle_of(1.0, 1.0, 1.0, 1.0, 1.0),
    "finite.*nan": lambda: cycle_of(BODY.gamma, nan, 1.0, 1.0, 1.0),
    "no limit cycle": lambda: Branch(lambda _: ideal_loop(), 0.0, 1.0).follow(
        0.5, LimitCycle("rest", loop=ideal_loop())
    ),
    "four finite numbers.*3": lambda: transfer(BODY, (1.0, 2.0, 3.0)),
    "four finite numbers.*nan": lambda: transfer(BODY, (1.0, 2.0, 3.0, nan)),
    "unstable": lambda: margins(BODY, np.zeros(4)),
    "above 0, given 0 rad/s": lambda: describing_function(0.0, 1.0, LAW),
    "frequency above 0.* 0 rad/s$": lambda: describing_function(1.0, 0.0, LAW),
    "above 0, given nan": lambda: describing_function(nan, 1.0, LAW),
    "maxwell_slip; give --law with one of coulomb, ": lambda: analysed_law(
        "maxwell_slip", furuta.Friction()
    ),
    "without delay, given D": lambda: joint(control.ss(A, B, C, 1)),
    "continuous time, given dt = 0.1": lambda: joint(control.ss(A, B, C, 0, 0.1)),
    "c·b is 0, must be above 0": lambda: joint(control.tf([1.0], [1.0, 1.0, 1.0])),
    "2 finite numbers": lambda: furuta.limit_cycle(joint(), start=np.zeros(3)),
    "theta cannot be": lambda: furuta.limit_cycle(joint(), theta=0.1),
    "law cannot be": lambda: furuta.limit_cycle(joint(), law="coulomb"),
    "linear cannot be": lambda: furuta.limit_cycle(joint(), linear=True),
    "theta cannot be combined": lambda: furuta.limit_cycle(theta=0.1, start=np.zeros(4)),
    # Axes.
    "alpha0": lambda: friction_from_text("alpha0", "stribeck"),
    "alpha0.*-1": lambda: friction_from_text("alpha0=-1", "stribeck"),
    "beta": lambda: friction_from_text("beta=1", "stribeck"),
    "needs stribeck_velocity above 0": lambda: friction_from_text("alpha0=1,alpha1=1", "stribeck"),
    "unbounded": lambda: compare_on_axis(AXIS, furuta.Pid(1.0, 100.0, 0.01)),
    "delay 0 to 1 s": lambda: furuta.simulate_axis(AXIS, PID, delay=-1.0),
    "load_friction": lambda: furuta.simulate_axis(AXIS._replace(load_friction=1.5), PID),
    "belong to an identified axis": lambda: furuta.study_axis(AXIS, PID, law="stiction"),
    # Studies.
    "expected NAME=": lambda: parse_swept_parameter("alpha0", 5),
    r"NAME=LOW:HIGH\[:COUNT\]": lambda: parse_swept_parameter("alpha0=0.1-0.3", 5),
    "LOW < HIGH": lambda: parse_swept_parameter("alpha0=2:1", 5),
    "has no range": lambda: parse_swept_parameter("compensation=0:1", 5),
    "once": lambda: swept(ALPHA0, ALPHA0),
    "at most": lambda: swept(SweptParameter("plant.seed", tuple(range(10_000_001)))),
    "one of none": lambda: candidate("nothing"),
    "expected PARAMETER=VALUE": lambda: candidate("compensation=lugre"),
    "alpha0 must be": lambda: candidate("a=alpha0=-1"),
    "only the plant": lambda: candidate("a=plant.friction.alpha0=1"),
    "seed.* are of random rigs": lambda: named_rigs(seed=1),
    "disturbances.* are of random rigs": lambda: named_rigs(disturbances=["lag"]),
    "rig.* are of random rigs": lambda: named_rigs(rig="paper"),
    "'named' or a table, given 'all'": lambda: furuta.compare(rigs="all"),
}


@pytest.mark.parametrize("reason", REFUSED)
def test_what_cannot_be_is_refused(reason: str) -> None:
    with pytest.raises(furuta.ParameterError, match=reason) as refusal:
        REFUSED[reason]()
    assert "\n" not in str(refusal.value)
