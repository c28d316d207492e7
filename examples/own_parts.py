"""Parts of one's own: a friction law and a compensator, as plain functions.

    tools/in_environment python examples/own_parts.py
    ./furuta limit-cycle --own-parts examples/own_parts.py:BUMP --law examples/own_parts.py:BUMP

Friction here is that of Dahl, but its level has a bump at 0.3 rad/s. The compensator is smooth and
learns the level from the observed friction.
"""

from dataclasses import dataclass
from math import exp, tanh
from typing import Any

import furuta


def level(v: float, p: Any) -> float:
    """g(v) [V] at the arm's speed v [rad/s]; p has the parameters of friction."""
    return p.alpha0 * (1.0 + 0.5 * exp(-(((abs(v) - 0.3) / 0.1) ** 2)))


BUMP = furuta.Law("bump", level, bristle=True, damped=False)


@dataclass
class Learned:
    """Memory of the compensator: the level [V], zero at the start."""

    level: float = 0.0


def learning(memory: Learned, x: Any, p: Any) -> float:
    """F̂ [V]; x is the state estimate and the observed friction [V]."""
    if abs(x[1]) > 0.1:
        memory.level += 5.0 * p.sample_time * (abs(x[4]) - memory.level)
    return memory.level * tanh(x[1] / 0.05)


def main() -> None:
    """Simulate, measure and find the cycle."""
    loop = furuta.make_loop({"friction.law": BUMP})
    for name, part in (("none", {}), ("learning", {"compensation": learning})):
        run = furuta.measure(loop, 60.0, **part)
        print(f"{name}: {run.phi_peak_to_peak_rad:.3f} rad")
    cycle = furuta.limit_cycle(loop)
    print(f"cycle: {cycle.phi_peak_to_peak_rad:.3f} rad, {cycle.period_s:.2f} s")


if __name__ == "__main__":
    main()
