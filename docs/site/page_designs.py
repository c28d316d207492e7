"""Everything that can be set on the page, and the designs that Python makes of it.

A knob has a few values, each of which is some settings by name. The knobs of a group are combined
in all ways. The page then needs no design of its own: it looks up the row of its knobs. Only the
strength of the compensation multiplies what the rows say.
"""

from collections.abc import Iterator, Mapping
from itertools import product
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from adjustable import numbers_of

import furuta
from furuta_friction.compensation import COMPENSATIONS
from furuta_model.parameters import SELECTS, fields_of
from furuta_sim.plant import Plant, design_plant
from furuta_sim.simulation.closed_loop import Loop
from furuta_sim.simulation.control_system import ControlSystem, design_control_system

Settings = Mapping[str, Any]
# A push that never begins: the page writes its own into the profile.
PUSH = {"pushes.times": [0.0], "pushes.durations": [0.0], "pushes.pendulum": [1.0]}
PUSHES = "plant_parts_pushes"
BASE = furuta.make_loop(PUSH)
FRICTION = BASE.plant.friction.parameters
LEVELS = (0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2)
STRENGTHS = (0, 0.1, 0.2, 0.3, 0.5, 0.75, 1, 1.25, 1.5, 2)
STRENGTH = "controller.strength"
WHOLE_TURN = {f"{node}.sensors.potentiometer_range": np.pi for node in ("plant", "estimator")}


class Knob(NamedTuple):
    """What can be turned: its name, title and meaning for the reader, and settings by value.

    A knob that multiplies a parameter names it, and its ``unit``: the page shows its value. Of the
    others ``words`` tells values that do not speak for themselves.
    """

    name: str
    title: str
    meaning: str
    values: dict[str, Settings]
    initial: str
    shows: str = ""
    unit: str = ""
    words: Mapping[str, str] = MappingProxyType({})


def times(factors: tuple[float, ...], **parameters: float) -> dict[str, Settings]:
    """Values of a knob that multiplies parameters; ``__`` stands for a dot."""
    return {
        f"{factor:g}": {name.replace("__", "."): factor * p for name, p in parameters.items()}
        for factor in factors
    }


MODE = Knob(
    "mode",
    "Controller",
    "balance: u = −Lx + F̂ until the pendulum has fallen; swing up: brings it up again",
    {
        "balance": {},
        "swing up": {
            "controller.mode": "swing_up",
            "controller.swing_up.recover": True,
            "estimator.method": "whole_circle",
            **WHOLE_TURN,
        },
        "off": {"controller.enabled": False},
    },
    "balance",
)
FRICTION_KNOBS = (
    Knob(
        "law",
        "Friction law",
        "LuGre: the arm moves a bristle before it slides, eq. (5); the others: it does not move "
        "while it sticks",
        {law: {"plant.friction.law": law} for law in ("lugre", "coulomb", "stiction")},
        "lugre",
        words={"lugre": "LuGre", "coulomb": "Coulomb", "stiction": "Stiction"},
    ),
    Knob(
        "level",
        "Friction level ×",
        f"true α₀ = {FRICTION.alpha0:g} V and α₁ = {FRICTION.alpha1:g} V, times this",
        times(
            LEVELS,
            plant__friction__alpha0=FRICTION.alpha0,
            plant__friction__alpha1=FRICTION.alpha1,
        ),
        "1",
        "plant.friction.alpha0",
        "V",
    ),
    Knob(
        "stiffness",
        "Bristle stiffness ×",
        f"true σ₀ = {FRICTION.sigma0:g} V/rad, times this",
        times((0.3, 1, 3), plant__friction__sigma0=FRICTION.sigma0),
        "1",
    ),
    Knob(
        "belt",
        "Belt between motor and arm",
        "the frequency is that at which an elastic belt vibrates",
        {f"{f:g}": {"plant.coupling.frequency": float(f)} for f in (0, 100, 50)},
        "0",
        words={"0": "rigid", "100": "elastic, 100 Hz", "50": "elastic, 50 Hz"},
    ),
)
SENSOR_KNOBS = (
    Knob(
        "sensors",
        "Sensors",
        "with noise: encoder, tachometer and potentiometer of the rig; ideal: all states exactly",
        {"rig": {}, "ideal": {"sensors.ideal": True}},
        "rig",
        words={"rig": "with noise"},
    ),
    MODE,
)
CONTROL_KNOBS = (
    Knob(
        "compensation",
        "Compensation",
        "how F̂ [V] is computed; recommended: LuGre friction of a learned level, and the rest",
        {name: {"friction_observer.compensation": name} for name in COMPENSATIONS},
        "none",
        "friction_observer.compensation",
    ),
    Knob(
        "believed",
        "Believed level ×",
        "α₀ and α₁ of the compensation's model, times this",
        times(
            LEVELS,
            friction_observer__alpha0=FRICTION.alpha0,
            friction_observer__alpha1=FRICTION.alpha1,
        ),
        "1",
        "friction_observer.alpha0",
        "V",
    ),
    Knob(
        "omega1",
        "Speed of the controller ×",
        f"ω₁ = {BASE.controller.poles.omega1:g} rad/s of the closed loop, times this; the gains L "
        "follow from it",
        times((0.7, 1, 1.25, 1.5), controller__omega1=BASE.controller.poles.omega1),
        "1",
    ),
    MODE,
)
DRIVE_KNOBS = (
    Knob(
        "motor",
        "Motor",
        "slow: its torque follows the command 10 ms later, with a lag of 15 ms",
        {"as it is": {}, "late": {"plant.drive.delay": 10, "plant.drive.lag": 0.015}},
        "as it is",
        words={"late": "slow"},
    ),
)
STRENGTH_KNOB = Knob(
    "strength",
    "Strength ×",
    "of the friction estimate: 0 for none, 1 for all of it",
    times(STRENGTHS, controller__strength=1.0),
    "1",
    STRENGTH,
)
# The knobs that set the numbers whose names begin so.
KNOBS = {
    ("plant_friction", "plant_substeps", "plant_parts_coupling"): FRICTION_KNOBS,
    ("plant_parts_drive",): DRIVE_KNOBS,
    ("plant_sensors", "control_estimator"): SENSOR_KNOBS,
    ("control_observer", "control_controller"): CONTROL_KNOBS,
}
ALL_KNOBS = {knob.name: knob for group in (*KNOBS.values(), (STRENGTH_KNOB,)) for knob in group}


class Design(NamedTuple):
    """The two records that compiled code runs with."""

    plant: Plant
    control: ControlSystem

    @property
    def numbers(self) -> dict[str, Any]:
        """All numbers by name."""
        return numbers_of(self.plant, "plant") | numbers_of(self.control, "control")


def loop_of(settings: Settings) -> Loop:
    """The loop with these settings, prepared for pushes; a strength multiplies what they say."""
    given = {name: value for name, value in settings.items() if name != STRENGTH}
    loop = furuta.make_loop({**PUSH, **given})
    balance = loop.controller.balance
    balance = balance._replace(strength=settings.get(STRENGTH, 1.0) * balance.strength)
    return loop._replace(controller=loop.controller._replace(balance=balance))


def design_of(loop: Loop) -> Design:
    """What the page computes with. Its drive has a delay, of 0 samples where there is none."""
    plant = design_plant(loop.plant)
    drive = plant.parts.drive._replace(delayed=True)
    return Design(
        plant._replace(parts=plant.parts._replace(drive=drive)),
        design_control_system(loop.estimator, loop.observer, loop.controller),
    )


def _selecting(record: Any, path: str) -> Iterator[str]:
    """Names of the numbers in a record that select what is translated."""
    for name, _, found in fields_of(record):
        value = getattr(record, name)
        if SELECTS in found:
            yield f"{path}_{name}"
        elif hasattr(value, "_fields"):
            yield from _selecting(value, f"{path}_{name}")


_BASE = design_of(BASE)
SELECTING = frozenset((*_selecting(_BASE.plant, "plant"), *_selecting(_BASE.control, "control")))


def combinations(knobs: tuple[Knob, ...]) -> Iterator[dict[str, Any]]:
    """Settings of all combinations; the last knob changes first."""
    for chosen in product(*(knob.values.values() for knob in knobs)):
        yield {name: value for settings in chosen for name, value in settings.items()}


class Group(NamedTuple):
    """Knobs, the designs of all their combinations, and the numbers that differ, in rows."""

    knobs: tuple[Knob, ...]
    designs: list[Design]
    numbers: dict[str, np.ndarray]


def group_of(prefixes: tuple[str, ...], knobs: tuple[Knob, ...]) -> Group:
    """All rows of the knobs for the numbers whose names begin with one of the prefixes."""
    designs = [design_of(loop_of(settings)) for settings in combinations(knobs)]
    all_numbers = [design.numbers for design in designs]
    numbers = {}
    for name, given in all_numbers[0].items():
        rows = np.array([np.ravel(each[name]) for each in all_numbers], dtype=float)
        same = np.tile(np.ravel(given), (len(rows), 1))
        # The page multiplies the strength, which no combination changes.
        varies = name.endswith("_strength") or not np.array_equal(rows, same, equal_nan=True)
        if name.startswith(prefixes) and varies:
            numbers[name] = rows
    return Group(knobs, designs, numbers)


def groups() -> list[Group]:
    """All groups."""
    return [group_of(prefixes, knobs) for prefixes, knobs in KNOBS.items()]
