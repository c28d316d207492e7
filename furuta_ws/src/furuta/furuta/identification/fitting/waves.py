"""Which waves of the motor's torque over the arm's turn the data contain."""

from furuta.identification.averaging import (
    ORDERS,
    Candidate,
    Catalogue,
    Model,
    most_probable,
)
from furuta.identification.shooting.optimisation import SURE, Optimum, optimise
from furuta.identification.shooting.unknowns import wave

# Over less than a turn neighbouring orders look alike; one of them stands for all.
WAVES = Catalogue([wave(order) for order in ORDERS])
# Length [s] of the segments in which waves are looked for first.
SEGMENT = 0.5


def with_waves(optimum: Optimum) -> Optimum:
    """The fit with all waves that it supports.

    Free runs have several optima, of which the one without the waves need not be the nearest. In
    short segments residuals are nearly linear in all values, so waves are looked for there first.
    """
    size = min(SEGMENT, optimum.window)
    short = optimise(
        optimum.recordings, optimum.keys, optimum.values, size, optimum.scale, robust=True
    )
    short = most_probable(short, _models, _refitted, SURE)
    orders = short.values.wave_orders
    if orders != optimum.values.wave_orders:
        added = [key for key in short.keys if key not in optimum.keys]
        starts = short.values, optimum.values.changed(added, short.values.vector(added))
        fits = [optimum.refitted(short.keys, start) for start in starts]
        optimum = min(fits, key=lambda each: each.cost)
    return most_probable(optimum, _models, _refitted, SURE)


def _models(optimum: Optimum) -> list[Candidate]:
    return optimum.neighbourhood(WAVES).candidates(WAVES)


def _refitted(optimum: Optimum, model: Model) -> Optimum:
    keys = model.keys(optimum.keys)
    changed = [key for group in (*model.added, *model.dropped) for key in group]
    return optimum.refitted(keys, optimum.values.changed(changed, [0.0] * len(changed)))
