"""State feedback: sign convention, limits, fall and catch."""

from typing import Any

import numpy as np
import pytest
from part_parameters import controller

from furuta_control.control import (
    ControllerMemory,
    ControllerParameters,
    control,
    design_controller,
    reset,
)
from furuta_control.excitation import ExcitationParameters
from furuta_control.modes.own import OwnControl
from furuta_model.accepted_parts import part_name
from furuta_model.block import new_memory

GAIN = (-1.0, -2.0, -30.0, -4.0)
RNG = np.random.default_rng(13)


def memory_of(balancing: bool = True) -> Any:
    """The memory of a controller that balances the pendulum, or does not."""
    memory = new_memory(ControllerMemory)
    memory["balance"]["balancing"] = balancing
    return memory[0]


def command(x: list[float] | np.ndarray, friction: float = 0.0, **parameters: object) -> float:
    """Command u [V] of a controller that balances the pendulum."""
    feedback = design_controller(controller(**{"gain": GAIN} | parameters))
    return control(memory_of(), np.array(x, dtype=float), friction, feedback)


def test_feedback_is_minus_lx() -> None:
    """Within the limits u = −Lx + F̂."""
    for x in RNG.uniform(-0.1, 0.1, (50, 4)):
        friction = RNG.uniform(-1, 1)
        assert command(x, friction) == pytest.approx(-np.dot(GAIN, x) + friction)


def test_saturation() -> None:
    """The command, including F̂, never exceeds the limit and keeps its sign."""
    limit = 2.5
    for x in RNG.uniform(-1, 1, (50, 4)) * [50, 50, 0.19, 50]:
        friction = RNG.uniform(-5, 5)
        expected = np.clip(-np.dot(GAIN, x) + friction, -limit, limit)
        found = command(
            x,
            friction,
            voltage_limit=limit,
            arm_angle_limit=50.0,
            arm_error_limit=50.0,
            arm_speed_limit=50.0,
        )
        assert found == pytest.approx(expected)


def test_fall_and_catch() -> None:
    """Beyond fall_angle the command is 0 V until the pendulum is within catch_angle."""
    memory, side = memory_of(False), -1
    tilts = [0.5, 0.21, 0.2, 0.5, 0.7, 0.71, 0.5, 0.21, 3.0]
    assert driven(memory, [[0, 0, side * tilt, 0] for tilt in tilts]) == [
        *(False, False, True, True, True),
        *(False, False, False, False),
    ]
    assert driven(memory, [[0, 0, side * 0.1, 0]] * 6) == [False] * 5 + [True]


CATCHING = controller(gain=GAIN, voltage_limit=100.0, catch_time=0.005)


def driven(
    memory: Any, states: list[list[float]], p: ControllerParameters = CATCHING
) -> list[bool]:
    """Whether the controller drives the arm in each state."""
    feedback = design_controller(p)
    return [control(memory, np.array(x, dtype=float), 0.1, feedback) != 0.0 for x in states]


FALLEN = [0, 0, 1.0, 0]
UPRIGHT = [0, 0, 0.01, 0]


def test_after_a_fall_only_a_slow_pendulum_is_caught() -> None:
    """A pendulum that passes through upright is not driven; one that stays there is."""
    memory = memory_of()
    passing = [[0, 0, 0.3 - 0.1 * k, -100.0] for k in range(7)]
    assert driven(memory, [FALLEN, *passing]) == [False] * 8
    assert driven(memory, [UPRIGHT] * 4 + [passing[3]] + [UPRIGHT] * 6) == [False] * 10 + [True]


def test_unknown_state_is_not_driven() -> None:
    """NaN in any state gives 0 V and counts as a fall."""
    for index in range(4):
        unknown = list(UPRIGHT)
        unknown[index] = float("nan")
        memory = memory_of()
        assert driven(memory, [UPRIGHT, unknown, UPRIGHT]) == [True, False, False]
        assert driven(memory, [UPRIGHT] * 5)[-1]


@pytest.mark.parametrize(("side", "index", "limit"), [(-1, 0, 6.283), (1, 1, 9.9)])
def test_arm_beyond_its_limits_is_not_driven(side: int, index: int, limit: float) -> None:
    """Nor is it caught there."""
    memory = memory_of()
    beyond, within = [0.0] * 4, [0.0] * 4
    beyond[index], within[index] = side * (limit + 0.01), side * (limit - 0.01)
    assert driven(memory, [within, beyond, within]) == [True, False, False]
    assert not any(driven(memory, [beyond] * 20))
    assert driven(memory, [within] * 6)[-1]


def test_new_start_forgets_a_fall() -> None:
    """After a reset the pendulum is caught at once; balancing is not interrupted."""
    memory = memory_of()
    assert driven(memory, [FALLEN, UPRIGHT]) == [False, False]
    reset(memory)
    assert driven(memory, [UPRIGHT, [0, 0, 0.5, 0]]) == [True, True]
    reset(memory)
    assert driven(memory, [[0, 0, 0.5, 0]]) == [True]


def test_disabled_controller_detects_a_fall() -> None:
    """A pendulum that fell while disabled is not driven when enabled beyond catch_angle."""
    memory = memory_of()
    disabled = design_controller(controller(gain=GAIN, enabled=False))
    enabled = design_controller(controller(gain=GAIN))
    control(memory, np.array([0, 0, 1.0, 0]), 0.0, disabled)
    assert control(memory, np.array([0, 0, 0.5, 0]), 0.0, enabled) == 0.0


def counting(memory: np.ndarray, x: np.ndarray, friction: float, p: OwnControl) -> float:
    """An own mode that integrates."""
    memory[0] += x[0]
    return memory[0]


@pytest.mark.parametrize("mode", ["balance", "own"])
def test_nothing_is_integrated_while_disabled(mode: str) -> None:
    """Once enabled, the first command is that of a controller that starts."""
    p = controller(
        mode=part_name(counting) if mode == "own" else mode,
        gain=GAIN,
        integral_time=0.5,
    )
    memory, x = memory_of(), np.array([0.2, 0.1, 0.01, 0.0])
    disabled = design_controller(p._replace(enabled=False))
    assert {control(memory, x, 0.1, disabled) for _ in range(1000)} == {0.0}
    x[1] = 0.15
    enabled = design_controller(p)
    assert control(memory, x, 0.1, enabled) == control(memory_of(), x, 0.1, enabled)


def excited(x: list[float], samples: int, **parameters: object) -> np.ndarray:
    """The excitation added to the command, sample by sample."""
    plain = controller(gain=GAIN, voltage_limit=1e3)
    p = plain._replace(excitation=ExcitationParameters(**parameters))
    memory, state = memory_of(), np.array(x)
    without = control(memory_of(), state, 0.1, design_controller(plain))
    feedback = design_controller(p)
    return np.array([control(memory, state, 0.1, feedback) for _ in range(samples)]) - without


@pytest.mark.parametrize("kind", ["steps", "sine", "multisine"])
def test_excitation_has_its_amplitude_and_period(kind: str) -> None:
    """It has its period, its amplitude and zero mean."""
    signal = excited([0.1, 0.2, 0.01, 0.0], 1000, kind=kind, amplitude=0.7, period=0.5)
    np.testing.assert_allclose(signal[:499], signal[500:999], atol=1e-9)
    assert np.max(np.abs(signal)) == pytest.approx(0.7, rel=2e-3)
    assert np.mean(signal) == pytest.approx(0.0, abs=2e-3)


@pytest.mark.parametrize("outside", [(2, -0.11), (0, 0.6), (1, 3.1)])
def test_excitation_is_zero_outside_its_limits(outside: tuple[int, float]) -> None:
    """Beyond a limit nothing is added and the phase is kept."""
    excitation = ExcitationParameters(
        "steps", 0.5, period=0.004, tilt_limit=0.1, excursion_limit=0.5, speed_limit=3.0
    )
    feedback = design_controller(controller(gain=GAIN, excitation=excitation))
    plain = design_controller(controller(gain=GAIN))
    memory, inside, beyond = memory_of(), np.zeros(4), np.zeros(4)
    beyond[outside[0]] = outside[1]
    states = [inside, beyond, beyond, beyond, inside, inside, inside]
    added = [
        control(memory, x, 0.0, feedback) - control(memory_of(), x, 0.0, plain) for x in states
    ]
    assert added == pytest.approx([0.5, 0.0, 0.0, 0.0, 0.5, -0.5, -0.5])


def test_open_loop_drives_a_hanging_pendulum() -> None:
    """The signal alone at any pendulum angle, within its limits, and only while enabled."""
    excitation = ExcitationParameters("steps", 0.5, speed_limit=3.0)
    feedback = design_controller(controller(mode="open_loop", gain=GAIN, excitation=excitation))
    hanging, fast = np.array([0.5, 1.0, np.pi, 2.0]), np.array([0.0, 3.1, np.pi, 0.0])
    assert control(memory_of(False), hanging, 0.2, feedback) == 0.5
    assert control(memory_of(False), fast, 0.2, feedback) == 0.0
    assert control(memory_of(False), hanging, 0.2, feedback._replace(enabled=False)) == 0.0


def test_balance_after_open_loop_waits_for_the_pendulum() -> None:
    """After open loop the pendulum must be caught, as after a fall."""
    memory, tilted = memory_of(), [0, 0, 0.5, 0]
    driven(memory, [tilted], CATCHING._replace(mode="open_loop"))
    assert driven(memory, [tilted, *[UPRIGHT] * 6, tilted]) == [False] * 6 + [True, True]


def test_a_far_arm_is_fed_back_as_a_near_one() -> None:
    """The arm's error is relative to the reference and limited; near it the feedback is linear."""
    assert command([0.5, 0, 0, 0], arm_reference=0.2) == pytest.approx(0.3)
    for phi, error in ((3.0, 1.0), (-9.0, -1.0), (0.99, 0.99)):
        found = command([phi, 0, 0, 0], arm_angle_limit=100.0)
        assert found == pytest.approx(error)
    assert command([5.0, 0, 0, 0], arm_error_limit=1e6) == pytest.approx(5.0)


def test_integral_action() -> None:
    """A constant error adds L₁ error t/T, limited as the error is. A fall clears it."""
    p = controller(gain=GAIN, integral_time=0.5, arm_error_limit=0.7)
    memory, design = memory_of(), design_controller(p)
    resting = np.array([0.2, 0, 0, 0])
    series = [control(memory, resting, 0.0, design) for _ in range(4000)]
    assert series[249] == pytest.approx(0.2 + 0.2 * 0.25 / 0.5)
    assert series[-1] == pytest.approx(0.2 + 0.7)
    control(memory, np.array([0.2, 0, 1.0, 0]), 0.0, design)
    assert memory["balance"]["integral"] == 0.0


def test_strength_changes_without_a_jump() -> None:
    """From the first sample it is the parameter; a change takes time, and 0 is no compensation."""
    p = controller(strength=2.0)
    x = np.array([0.0, 0.1, 0.0, 0.0])
    none = control(memory_of(), x, 0.0, design_controller(controller()))
    memory, design = memory_of(), design_controller(p)
    before = [control(memory, x, 0.2, design) for _ in range(300)][-1]
    assert control(memory_of(), x, 0.2, design) == pytest.approx(none + 0.4)
    design = design_controller(p._replace(balance=p.balance._replace(strength=0.0)))
    series = np.array([before, *(control(memory, x, 0.2, design) for _ in range(1500))])
    assert np.max(np.abs(np.diff(series))) < 0.02 * abs(before - none)
    assert series[-1] == pytest.approx(none, abs=1e-6)
