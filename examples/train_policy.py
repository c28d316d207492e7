"""Train a small policy by evolution, and compare it with a designed loop on unknown rigs.

    tools/in_environment python -m pip install --requirement examples/requirements.lock
    tools/in_environment python examples/train_policy.py

The policy is u = −k·(φ, φ̇, θ, θ̇) + c tanh(φ̇/w), with θ̇ from a filtered difference of the measured
θ. The library cma finds k, c, w and the filter from random rigs. Then the policy and the
super-twisting loop of the library run for 60 s on each of 1 000 other random rigs.
"""

from time import process_time
from typing import Any

import cma
import numpy as np
from gymnasium.envs.classic_control.cartpole import CartPoleVectorEnv

import furuta
from furuta.gym import FurutaVectorEnv, random_plants
from furuta.lanes.batch import batch
from furuta_model.state import PHI

# Policies of a generation, rigs for each, samples of an episode, generations.
POLICIES, RIGS, SAMPLES, GENERATIONS = 16, 24, 4000, 60
# Size of each number of a policy at the start [V/rad, V s/rad, V/rad, V s/rad, V].
SCALE = np.array([1.0, 1.0, 10.0, 1.0, 0.1])
JUDGED, SECONDS = 1000, 60.0


class Policy:
    """Policies (n, 7), each of which runs on ``rigs`` rigs."""

    def __init__(self, numbers: np.ndarray, rigs: int) -> None:
        every = np.repeat(np.atleast_2d(numbers), rigs, axis=0)
        self._gains = every[:, :5] * SCALE
        self._width = 0.05 * np.exp(every[:, 5])
        self._share = 1.0 / (1.0 + np.exp(3.0 - every[:, 6]))
        self._theta = self._rate = np.zeros(len(every))

    def start(self, observation: np.ndarray) -> None:
        """Begin at rest."""
        self._theta, self._rate = self._angle(observation), np.zeros(len(observation))

    def __call__(self, observation: np.ndarray) -> np.ndarray:
        """Actions (n, 1)."""
        theta = self._angle(observation)
        self._rate = self._rate + self._share * ((theta - self._theta) / 0.001 - self._rate)
        self._theta = theta
        x = np.stack([observation[:, 0], observation[:, 1], theta, self._rate], axis=1)
        friction = self._gains[:, 4] * np.tanh(observation[:, 1] / self._width)
        u = friction - np.sum(self._gains[:, :4] * x, axis=1)
        return np.clip(u / 10.0, -1.0, 1.0)[:, None].astype(np.float32)

    @staticmethod
    def _angle(observation: np.ndarray) -> np.ndarray:
        return np.arctan2(observation[:, 2], observation[:, 3])


def returns(numbers: np.ndarray, envs: Any, seed: int) -> np.ndarray:
    """Mean sum of rewards of each policy; an episode counts up to its end."""
    rigs = envs.num_envs // len(numbers)
    policy, alive, total = Policy(numbers, rigs), np.ones(envs.num_envs), np.zeros(envs.num_envs)
    observation, _ = envs.reset(seed=seed)
    policy.start(observation)
    for _ in range(SAMPLES):
        observation, reward, ended, _, _ = envs.step(policy(observation))
        total += alive * reward
        alive *= ~ended
        if not alive.any():
            break
    return total.reshape(len(numbers), rigs).mean(axis=1)


def train() -> np.ndarray:
    """The numbers of the best policy."""
    envs = FurutaVectorEnv(POLICIES * RIGS, plants=random_plants(1000), max_episode_steps=10**9)
    options = {"popsize": POLICIES, "seed": 1, "verbose": -9}
    search = cma.CMAEvolutionStrategy(np.zeros(7), 1.0, options)
    for generation in range(GENERATIONS):
        tried = search.ask()
        got = returns(np.array(tried), envs, generation)
        search.tell(tried, list(-got))
        if generation % 10 == 9:
            print(f"generation {generation + 1}: return {got.mean():.0f} of {SAMPLES}", flush=True)
    return np.asarray(search.result.xfavorite)


def judge(numbers: np.ndarray, plants: list[Any]) -> np.ndarray:
    """The arm's residual, peak to peak [rad], on each plant; infinite after a fall."""
    n, samples = len(plants), round(SECONDS * 1000)
    envs, policy = FurutaVectorEnv(n, plants=plants, max_episode_steps=10**9), Policy(numbers, n)
    observation, _ = envs.reset(seed=0, options={"plants": np.arange(n)})
    policy.start(observation)
    low, high, fell = np.full(n, np.inf), np.full(n, -np.inf), np.zeros(n, bool)
    for k in range(samples):
        observation, _, ended, _, _ = envs.step(policy(observation))
        fell |= ended
        if 2 * k >= samples:
            phi = envs.states[:, PHI]
            low, high = np.minimum(low, phi), np.maximum(high, phi)
    return np.where(fell, np.inf, high - low)


def judge_loop(settings: dict[str, Any], plants: list[Any]) -> np.ndarray:
    """The same for a loop of the library."""
    loop = furuta.make_loop(settings)
    outcomes = batch((loop._replace(plant=plant) for plant in plants), SECONDS)
    return np.array([np.inf if o.fell else o.phi_peak_to_peak_rad for o in outcomes])


def print_rates() -> None:
    """Steps per second of a core, beside CartPole's vector environment."""
    for name, kind, action in (
        ("furuta, 1 kHz", FurutaVectorEnv, np.zeros((4096, 1), np.float32)),
        ("CartPole", CartPoleVectorEnv, np.zeros(4096, int)),
    ):
        envs: Any = kind(4096)
        envs.reset(seed=0)
        envs.step(action)
        start = process_time()
        for _ in range(200):
            envs.step(action)
        print(f"{name}: {200 * 4096 / (process_time() - start) / 1e6:.1f} million steps/s")


def main() -> None:
    """Train, judge, print the table."""
    print_rates()
    numbers = train()
    print("policy", np.round(numbers[:5] * SCALE, 3), np.round(numbers[5:], 2))
    plants = random_plants(JUDGED, training=False)
    for name, size in (
        ("policy", judge(numbers, plants)),
        ("super_twisting", judge_loop({"super_twisting": 10.0}, plants)),
        ("none", judge_loop({}, plants)),
    ):
        standing = size[np.isfinite(size)]
        median, high = np.quantile(standing, [0.5, 0.95])
        falls = len(size) - len(standing)
        print(f"{name:15} median {median:.4f} rad, 95 % {high:.4f} rad, falls {falls}")


if __name__ == "__main__":
    main()
