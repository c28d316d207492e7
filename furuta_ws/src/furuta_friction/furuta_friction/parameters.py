"""Parameters of the friction observer."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from furuta_model.lugre import LuGre
from furuta_model.parameters import INLINE, About

COMPENSATIONS = ("none", "coulomb", "lugre")


class ObserverParameters(NamedTuple):
    """Parameters of the node ``friction_observer``."""

    compensation: Annotated[
        str,
        About(
            "none: 0 V; coulomb: eq. (4) with level alpha0; lugre: the observer (9)",
            choices=COMPENSATIONS,
        ),
    ] = "none"
    friction: Annotated[LuGre, INLINE] = LuGre()
    observer_gain: Annotated[
        float, About("correction gain K of the observer on the arm angle", "1/s", 0.0, 1e3)
    ] = 0.01
    sample_time: Annotated[
        float, About("time between state estimates", "s", 1e-5, 0.1, read_only=True)
    ] = 0.001
