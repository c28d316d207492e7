"""Environments of gymnasium: one rig or many with friction, sample by sample.

    import gymnasium, furuta.gym
    envs = gymnasium.make_vec("furuta/Balance-v0", 64, plants=furuta.gym.random_plants(1000))

They are the simulated plants of :mod:`furuta_sim.plant`, with sensors, drive, any friction law and
any part. The observation is φ [rad], φ̇ [rad/s], sin θ and cos θ, as the sensors measure them, and
the last action. θ̇ is not measured. The action is the command as a fraction of ``VOLTAGE``. The
reward of a sample is cos θ − φ²/10 − u²/100. An episode ends beyond the limits of the arm, and in
task ``balance`` beyond ``FALL_ANGLE``. gymnasium is not among the library's requirements
(``pip install '.[gym]'`` in the folder of this repository).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi
from typing import Any

import numpy as np

from furuta.arguments import check, checked
from furuta.loops import make_loop
from furuta.settings.settings import default_settings
from furuta.studies.comparison.rigs import JUDGING, TRAINING, RandomRigs
from furuta_model.block import block
from furuta_model.compiled import compiled, inlined
from furuta_model.elementary import sin_cos
from furuta_model.optional import needed_by
from furuta_model.parameters import ParameterError, shortened
from furuta_model.state import PHI, PHI_DOT, RIGID_STATES, SIGNALS, THETA
from furuta_sim.parameters import PlantParameters
from furuta_sim.plant import NOISE_CHANNELS, design_plant, initial_plant, move, read

with needed_by("furuta.gym"):
    import gymnasium
    from gymnasium.spaces import Box
    from gymnasium.vector import AutoresetMode, VectorEnv
    from gymnasium.vector.utils import batch_space

VOLTAGE = 10.0  # of the action 1 [V]
FALL_ANGLE = 0.7  # [rad]
ARM_ANGLE, ARM_SPEED = 2.0 * pi, 100.0  # [rad, rad/s]
ARM_COST, COMMAND_COST = 0.1, 0.01  # of φ² [1/rad²] and u² [1/V²]
# An episode starts within these of upright, or of hanging, at random [rad, rad/s].
START = np.array([0.5, 0.1, 0.1, 0.1])
# Samples of an episode.
SAMPLES = 10_000
# The rig of each task, with a sensor of a full turn for the swing-up.
RIGS = {"balance": "paper", "swing_up": "paper_full_turn"}


@checked
def random_plants(
    number: int, seed: int = 0, disturbances: Sequence[str] = (), training: bool = True
) -> list[PlantParameters]:
    """Plants of random rigs, as those of :mod:`furuta.studies.comparison.rigs`.

    Those for ``training`` are others than those that ``furuta compare`` judges by.
    """
    settings, purpose = default_settings(), TRAINING if training else JUDGING
    rigs = RandomRigs(settings, number, seed, tuple(disturbances), purpose=purpose)
    return [rig.plant(settings) for rig in rigs]


class _Rigs:
    """Simulated rigs, each of which starts anew with one of ``plants`` at random."""

    def __init__(self, number: int, task: str, plants: Sequence[PlantParameters]) -> None:
        if task not in RIGS:
            raise ParameterError(f"task must be one of {', '.join(RIGS)}, given {task}")
        plants = plants or [make_loop(rig=RIGS[task]).plant]
        self._designs = np.concatenate([block(design_plant(plant)) for plant in plants])
        self._initial = initial_plant(plants[0])
        self._initial["x"] = 0.0
        self._balances = task == "balance"
        self.memory = np.repeat(self._initial, number)
        self._plants = np.repeat(self._designs[:1], number)

    def check_reset(self, seed: Any, options: Any) -> np.ndarray | None:
        """Reject arguments of ``reset``; the plants (indices) that the options name, if they do."""
        if check("seed", seed, int | None) is not None and seed < 0:
            raise ParameterError(f"seed must be at least 0, given {seed}")
        options = check("options", options, Mapping[str, Any] | None) or {}
        if unknown := options.keys() - {"plants"}:
            raise ParameterError(f"the only option is plants, given {', '.join(sorted(unknown))}")
        if "plants" not in options:
            return None
        given, last = np.asarray(options["plants"]), len(self._designs) - 1
        right = given.shape == self.memory.shape and given.dtype.kind in "iu"
        if not (right and given.min() >= 0 and given.max() <= last):
            wanted = f"{len(self.memory)} indices from 0 to {last}"
            raise ParameterError(f"plants must be {wanted}, given {shortened(options['plants'])}")
        return given

    def start(
        self, which: np.ndarray, random: np.random.Generator, plants: np.ndarray | None = None
    ) -> np.ndarray:
        """Start the rigs ``which`` (indices) anew; returns their observations.

        They are those with the indices ``plants``, or random ones.
        """
        chosen = random.integers(len(self._designs), size=len(which))
        designs = self._designs[chosen if plants is None else plants]
        memory = np.repeat(self._initial, len(which))
        memory["x"][:, :RIGID_STATES] = START * random.uniform(-1.0, 1.0, (len(which), len(START)))
        memory["x"][:, THETA] += 0.0 if self._balances else pi
        self.memory[which], self._plants[which] = memory, designs
        observations = np.zeros((len(which), OBSERVED), np.float32)
        noise = random.standard_normal((len(which), NOISE_CHANNELS))
        _read(memory, designs, noise, observations)
        return observations

    def step(
        self, actions: np.ndarray, random: np.random.Generator
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Observations, rewards, and which episodes have ended, after a sample."""
        n = len(self.memory)
        if actions.size != n or actions.dtype.kind not in "iuf" or not np.isfinite(actions).all():
            given = shortened(actions.tolist())
            raise ParameterError(f"each of {n} actions must be a finite number, given {given}")
        observations = np.empty((n, OBSERVED), np.float32)
        rewards, ended = np.empty(n), np.empty(n, bool)
        noise = random.standard_normal((n, NOISE_CHANNELS))
        clipped = np.clip(actions.reshape(n).astype(float), -1.0, 1.0)
        limit = FALL_ANGLE if self._balances else np.inf
        _step(self.memory, self._plants, noise, clipped, limit, observations, rewards, ended)
        return observations, rewards, ended


# Length of an observation.
OBSERVED = 5
_HIGHEST = np.array([ARM_SPEED, ARM_SPEED, 1.0, 1.0, 1.0], np.float32)
_OBSERVATIONS = Box(-_HIGHEST, _HIGHEST, dtype=np.float32)
_ACTIONS = Box(-1.0, 1.0, (1,), np.float32)


class FurutaEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """One simulated rig; its ``task`` is balance or swing_up."""

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 - as gymnasium declares it
    observation_space, action_space = _OBSERVATIONS, _ACTIONS

    @checked
    def __init__(self, task: str = "balance", plants: Sequence[PlantParameters] = ()) -> None:
        self._rigs = _Rigs(1, task, plants)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start anew; see :meth:`FurutaVectorEnv.reset`."""
        plants = self._rigs.check_reset(seed, options)
        super().reset(seed=seed)
        return self._rigs.start(np.array([0]), self.np_random, plants)[0], {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Move by a sample."""
        observations, rewards, ended = self._rigs.step(np.asarray(action), self.np_random)
        return observations[0], float(rewards[0]), bool(ended[0]), False, {}


class FurutaVectorEnv(VectorEnv[np.ndarray, np.ndarray, np.ndarray]):
    """Many simulated rigs; after the end of an episode the next step starts another one."""

    metadata: dict[str, Any] = {"autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    @checked
    def __init__(
        self,
        num_envs: int = 1,
        task: str = "balance",
        plants: Sequence[PlantParameters] = (),
        max_episode_steps: int = SAMPLES,
    ) -> None:
        if min(num_envs, max_episode_steps) < 1:
            given = f"{num_envs} and {max_episode_steps}"
            raise ParameterError(f"num_envs and max_episode_steps must be above 0, given {given}")
        self.num_envs, self._last = num_envs, max_episode_steps
        self.single_observation_space, self.single_action_space = _OBSERVATIONS, _ACTIONS
        self.observation_space = batch_space(_OBSERVATIONS, num_envs)
        self.action_space = batch_space(_ACTIONS, num_envs)
        self._rigs = _Rigs(num_envs, task, plants)
        self._samples, self._done = np.zeros(num_envs, int), np.zeros(num_envs, bool)

    @property
    def states(self) -> np.ndarray:
        """True states x (num_envs, 4), which are not observed."""
        states: np.ndarray = self._rigs.memory["x"][:, :RIGID_STATES]
        return states

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start all anew, with plants at random or as the option ``plants`` (indices) says.

        One ``seed`` is for all: they share one generator.
        """
        plants = self._rigs.check_reset(seed, options)
        super().reset(seed=seed)
        self._samples[:], self._done[:] = 0, False
        return self._rigs.start(np.arange(self.num_envs), self.np_random, plants), {}

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Move by a sample."""
        observations, rewards, ended = self._rigs.step(np.asarray(actions), self.np_random)
        self._samples += 1
        late = self._samples >= self._last
        if self._done.any():
            anew = np.flatnonzero(self._done)
            observations[anew] = self._rigs.start(anew, self.np_random)
            rewards[anew], ended[anew], late[anew], self._samples[anew] = 0.0, False, False, 0
        self._done = ended | late
        return observations, rewards, ended, late, {}


@inlined
def _observe(measurement: np.ndarray, observation: np.ndarray) -> None:
    """Write what is observed, but the action."""
    observation[0], observation[1] = measurement[PHI], measurement[PHI_DOT]
    observation[2], observation[3] = sin_cos(measurement[THETA])


@compiled
def _read(
    memory: np.ndarray, plants: np.ndarray, noise: np.ndarray, observations: np.ndarray
) -> None:
    measurement = np.empty(SIGNALS)
    for i in range(len(memory)):
        read(memory[i], noise[i], plants[i], measurement)
        _observe(measurement, observations[i])


@compiled
def _step(
    memory: np.ndarray,
    plants: np.ndarray,
    noise: np.ndarray,
    actions: np.ndarray,
    fall_angle: float,
    observations: np.ndarray,
    rewards: np.ndarray,
    ended: np.ndarray,
) -> None:
    measurement = np.empty(SIGNALS)
    for i in range(len(memory)):
        rig, u = memory[i], VOLTAGE * actions[i]
        move(rig, u, plants[i])
        read(rig, noise[i], plants[i], measurement)
        _observe(measurement, observations[i])
        observations[i, OBSERVED - 1] = actions[i]
        phi, v, theta = rig.x[PHI], rig.x[PHI_DOT], rig.x[THETA]
        _, upright = sin_cos(theta)
        rewards[i] = upright - ARM_COST * phi * phi - COMMAND_COST * u * u
        ended[i] = abs(theta) > fall_angle or abs(phi) > ARM_ANGLE or abs(v) > ARM_SPEED


for _name, _task in (("Balance", "balance"), ("SwingUp", "swing_up")):
    gymnasium.register(
        f"furuta/{_name}-v0",
        entry_point="furuta.gym:FurutaEnv",
        vector_entry_point="furuta.gym:FurutaVectorEnv",
        max_episode_steps=SAMPLES,
        kwargs={"task": _task},
    )
