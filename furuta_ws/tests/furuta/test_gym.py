"""The environments: gymnasium's checker, and one rig beside many and beside the plant itself."""

import warnings
from typing import Any

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env  # noqa: E402

import furuta  # noqa: E402
from furuta.gym import FALL_ANGLE, VOLTAGE, FurutaEnv, FurutaVectorEnv, random_plants  # noqa: E402

TASKS = {"balance": "furuta/Balance-v0", "swing_up": "furuta/SwingUp-v0"}


@pytest.mark.parametrize("task", TASKS)
def test_gymnasium_finds_nothing(task: str) -> None:
    """Every warning of its checker is an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(TASKS[task]).unwrapped)


@pytest.mark.parametrize("task", TASKS)
def test_many_are_what_one_is(task: str) -> None:
    """A vector environment of one has the same episodes as the single one."""
    one, many = FurutaEnv(task), FurutaVectorEnv(1, task)
    alone, together = one.reset(seed=3)[0], many.reset(seed=3)[0]
    random = np.random.default_rng(0)
    for _ in range(500):
        np.testing.assert_array_equal(together[0], alone)
        assert alone in one.observation_space
        action = random.uniform(-1.0, 1.0, (1, 1)).astype(np.float32)
        alone, reward, ended, _, _ = one.step(action[0])
        together, rewards, all_ended, late, _ = many.step(action)
        assert (reward, ended) == (rewards[0], all_ended[0])
        assert not late[0]
        if ended:
            break
    assert ended == (task == "balance")


def test_vector_environment_follows_the_interface() -> None:
    """Seeds, and a new episode in the step after the end of one."""
    envs = gymnasium.make_vec(
        TASKS["balance"], 6, vectorization_mode="vector_entry_point"
    ).unwrapped
    first, _ = envs.reset(seed=1)
    again, _ = envs.reset(seed=1)
    np.testing.assert_array_equal(first, again)
    push = np.ones((6, 1), np.float32)
    ended = np.zeros(6, bool)
    while not ended.any():
        before = ended
        _, _, ended, late, _ = envs.step(push)
        assert not (before | late).any()
        np.testing.assert_array_equal(ended, np.abs(envs.states[:, 2]) > FALL_ANGLE)
    _, rewards, fresh, _, _ = envs.step(push)
    assert not fresh[ended].any()
    assert np.all(rewards[ended] == 0.0)
    assert np.all(np.abs(envs.states[ended, 2]) <= 0.1)


def test_episode_has_its_length() -> None:
    """Held by the feedback of the library, it ends by time alone."""
    envs = FurutaVectorEnv(3, max_episode_steps=50)
    gain = np.array(furuta.Loop().controller.feedback_gain)
    envs.reset(seed=0)
    ends = []
    for _ in range(102):
        action = -envs.states @ gain / VOLTAGE
        _, _, ended, late, _ = envs.step(action[:, None].astype(np.float32))
        assert not ended.any()
        ends.append(bool(late.all()))
    assert [k for k, end in enumerate(ends) if end] == [49, 100]


def test_rigs_move_as_the_simulated_plant() -> None:
    """The motion under a command is that of the closed loop's plant, for any of the plants."""
    plants = random_plants(3, disturbances=("lag", "turn", "cogging"))
    envs = FurutaVectorEnv(3, plants=plants)
    envs.reset(seed=0, options={"plants": [2, 0, 1]})
    start, push = envs.states.copy(), np.full((3, 1), 0.5 / VOLTAGE)
    moved = [envs.states.copy() for _ in range(200) if envs.step(push) is not None]
    for k, number in enumerate((2, 0, 1)):
        initial = type(plants[number].initial)(*start[k].tolist())
        loop = furuta.Loop()._replace(plant=plants[number]._replace(initial=initial))
        run = furuta.simulate(loop, 0.2, controller=half_a_volt)
        np.testing.assert_allclose(
            [row[k] for row in moved[:-1]], run.state[1:], rtol=0, atol=1e-12
        )


def half_a_volt(memory: Any, x: Any, friction: float, p: Any) -> float:
    """A constant command [V]."""
    return 0.5


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda envs: FurutaEnv("juggle"), "task must be one of balance, swing_up"),
        (lambda envs: envs.reset(options={"plants": [0, 5]}), "2 indices from 0 to 2, given"),
        (lambda envs: envs.step([[0.0], [np.nan]]), "each of 2 actions must be a finite number"),
    ],
)
def test_nonsense_is_refused_and_changes_nothing(call: Any, reason: str) -> None:
    envs, twin = (FurutaVectorEnv(2, plants=random_plants(3)) for _ in range(2))
    envs.reset(seed=0), twin.reset(seed=0)
    with pytest.raises(furuta.ParameterError, match=reason):
        call(envs)
    action = np.full((2, 1), 0.1, np.float32)
    np.testing.assert_array_equal(envs.step(action)[0], twin.step(action)[0])
