"""Train a policy on random rigs with gymnasium, and judge it on 200 rigs that it has not seen.

    tools/in_environment python -m pip install --requirement examples/requirements.lock
    tools/in_environment python examples/train_policy.py    # takes a minute

The policy is u = −k·(φ, φ̇, θ, θ̇) + c tanh(φ̇/w), with θ̇ from a filtered difference of the measured
θ. The cross-entropy method finds its seven numbers: each generation is drawn about the best
policies of the one before.
"""

from typing import Any

import numpy as np

import furuta
from furuta.gym import FurutaVectorEnv, random_plants

POLICIES, BEST, RIGS, GENERATIONS = 32, 8, 16, 20
SCALE = np.array([1.0, 1.0, 10.0, 1.0, 0.1])  # of k and −c [V/rad, V s/rad, V/rad, V s/rad, V]


def run(envs: Any, policies: np.ndarray, rigs: np.ndarray, samples: int) -> Any:
    """Reward (n,) until a fall, and the arm's peak to peak (n,) [rad], infinite after a fall."""
    gains, width = policies[:, :5] * SCALE, 0.05 * np.exp(policies[:, 5])
    share = 1.0 / (1.0 + np.exp(3.0 - policies[:, 6]))
    seen, _ = envs.reset(seed=0, options={"plants": rigs})
    theta, rate = np.arctan2(seen[:, 2], seen[:, 3]), np.zeros(len(rigs))
    total, stands, arm = np.zeros(len(rigs)), np.ones(len(rigs), bool), []
    for _ in range(samples):
        before, theta = theta, np.arctan2(seen[:, 2], seen[:, 3])
        rate = rate + share * ((theta - before) / 0.001 - rate)
        x = np.stack([*seen[:, :2].T, theta, rate, np.tanh(seen[:, 1] / width)], axis=1)
        seen, reward, ended, _, _ = envs.step(-np.sum(gains * x, axis=1) / 10.0)
        stands &= ~ended
        total += stands * reward
        arm.append(envs.states[:, 0].copy())
    return total, np.where(stands, np.ptp(arm[samples // 2 :], axis=0), np.inf)


random, mean, spread = np.random.default_rng(1), np.zeros(7), np.ones(7)
envs = FurutaVectorEnv(POLICIES * RIGS, plants=random_plants(1000), max_episode_steps=10**9)
for _ in range(GENERATIONS):
    tried = mean + spread * random.standard_normal((POLICIES, 7))
    rigs = np.tile(random.integers(1000, size=RIGS), POLICIES)  # the same for all policies
    rewards, _ = run(envs, np.repeat(tried, RIGS, axis=0), rigs, 4000)
    best = tried[np.argsort(rewards.reshape(POLICIES, RIGS).mean(axis=1))[-BEST:]]
    mean, spread = best.mean(axis=0), best.std(axis=0)

unseen = random_plants(200, training=False)
envs = FurutaVectorEnv(len(unseen), plants=unseen, max_episode_steps=10**9)
_, sizes = run(envs, np.tile(mean, (len(unseen), 1)), np.arange(len(unseen)), 30_000)
print(f"policy: median {np.median(sizes):.3f} rad, {np.isinf(sizes).sum()} falls")
loops = ("recommended", "none")
runs = furuta.compare(candidates=loops, rigs=len(unseen), keep_runs=True).runs
for name in loops:
    mine = runs["candidate"] == name
    size, falls = np.median(runs["phi_peak_to_peak_rad"][mine]), int(runs["fell"][mine].sum())
    print(f"{name}: median {size:.3f} rad, {falls} falls")

# prints
# policy: median 0.057 rad, 0 falls
# recommended: median 0.003 rad, 0 falls
# none: median 0.507 rad, 0 falls
