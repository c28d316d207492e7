"""Parameters of the friction observer."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from furuta_model.lugre import LuGre
from furuta_model.parameters import INLINE, About

COMPENSATIONS = ("none", "coulomb", "stiction", "lugre", "adaptive")
# Those that need to see the friction: an estimate of it beside that of the state.
NEEDS_OBSERVED_FRICTION = ("stiction", "adaptive")


class ObserverParameters(NamedTuple):
    """Parameters of the node ``friction_observer``."""

    compensation: Annotated[
        str,
        About(
            "none: 0 V; coulomb: eq. (4) with level alpha0; stiction: that, and at rest what is "
            "held; lugre: the observer (9); adaptive: the same with levels that adapt",
            choices=COMPENSATIONS,
        ),
    ] = "none"
    friction: Annotated[LuGre, INLINE] = LuGre()
    observer_gain: Annotated[
        float, About("correction gain K of the observer on the arm angle", "1/s", -1e3, 1e3)
    ] = 0.01
    adaptation_gain: Annotated[
        float, About("adaptive: rate at which a level follows while the arm slides", "1/s", 0, 1e3)
    ] = 20.0
    sample_time: Annotated[
        float, About("time between state estimates", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001
