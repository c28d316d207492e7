"""Which waves of the motor's torque over the arm's turn the data contain.

Each wave changes the residuals of short segments in proportion to its amplitude. Waves are added
one by one: the one that explains most of those that blocks of time support. What a change of the
other unknowns could explain too does not count.
"""

import numpy as np

from furuta.identification.least_squares import in_blocks
from furuta.identification.selection import tested
from furuta.identification.shooting.optimisation import Optimum, optimise
from furuta.identification.shooting.unknowns import wave
from furuta_model.state import PHI

# Waves per turn that are tried, and most waves.
HIGHEST_ORDER, MOST_WAVES = 60, 6
# Largest probability by chance of a wave, which is the best of many.
BY_CHANCE = 1e-5
# Turns of the arm, in one of the recordings, that show waves. Over less than a turn neighbouring
# orders look alike; one of them stands for all.
FEWEST_TURNS = 0.25
# Length [s] of the segments, and of a block within them.
SEGMENT, BLOCK = 0.5, 0.1


def significant_orders(optimum: Optimum) -> list[int]:
    """Orders of the waves that the data contain beyond those of the model."""
    recordings, values = optimum.recordings, optimum.values
    turns = max(float(np.ptp(r.measured[:, PHI])) for r in recordings) / (2.0 * np.pi)
    if turns < FEWEST_TURNS:
        return []
    short = optimise(recordings, (), values, SEGMENT, optimum.scale, robust=False)
    orders = [n for n in range(2, HIGHEST_ORDER + 1) if n not in values.wave_orders]
    about = short.about([*optimum.keys, *(key for order in orders for key in wave(order))])
    about = in_blocks(about, short.problem.cut, short.fit.state, BLOCK)
    known = list(range(len(optimum.keys)))
    groups = {order: [len(known) + 2 * k, len(known) + 2 * k + 1] for k, order in enumerate(orders)}
    found: list[int] = []
    while len(found) < MOST_WAVES:
        chances, gains = tested(about, known, list(groups.values()))
        if not np.any(chances < BY_CHANCE):
            break
        best = list(groups)[int(np.argmax(np.where(chances < BY_CHANCE, gains, -1.0)))]
        known += groups.pop(best)
        found.append(best)
    return sorted(found)
