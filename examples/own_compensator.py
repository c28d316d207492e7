"""A compensator of your own is a Python function: here a smooth one that learns its level.

tools/in_environment python examples/own_compensator.py
part=examples/own_compensator.py:learning
./furuta simulate --own-parts $part --compensation $part
"""

from dataclasses import dataclass
from math import tanh
from typing import Any

import furuta


@dataclass
class Learned:
    """Memory of the compensator: the level [V], zero at the start."""

    level: float = 0.0


def learning(memory: Learned, x: Any, p: Any) -> float:
    """F̂ [V]; x is the state estimate (φ, φ̇, θ, θ̇) and the observed friction [V]."""
    if abs(x[1]) > 0.1:
        memory.level += 5.0 * p.sample_time * (abs(x[4]) - memory.level)
    return memory.level * tanh(x[1] / 0.05)


if __name__ == "__main__":
    for name, compensation in (("none", "none"), ("learning", learning)):
        run = furuta.measure(furuta.make_loop({"compensation": compensation}))
        print(f"{name}: {run.phi_peak_to_peak_rad:.3f} rad")

# prints
# none: 0.511 rad
# learning: 0.089 rad
