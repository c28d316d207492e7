"""Theorems on friction and limit cycles, each with its source and what the engine finds.

Of the papers only the abstracts were read. Nothing is claimed of them beyond the statements here.
"""

from time import perf_counter
from typing import Any, NamedTuple

from furuta_model.parameters import ParameterError


class Theorem(NamedTuple):
    """Source and statement; :mod:`furuta.axis.theorem_checks` has the check of the same name."""

    source: str
    statement: str


THEOREMS = {
    "coulomb": Theorem(
        "Bisoffi, Da Lio, Teel, Zaccarian, IEEE Trans. Automatic Control 63(8), 2018",
        "Under Coulomb friction alone every stabilising PID brings the axis to rest.",
    ),
    "stiction": Theorem(
        "Armstrong, Amin, Automatica 32(5), 1996",
        "With static friction above Coulomb's every stabilising PID hunts.",
    ),
    "fold": Theorem(
        "Hensen, van de Molengraft, Steinbuch, Friction induced limit cycling: hunting",
        "With Stribeck and LuGre friction hunting disappears beyond the gain of a cyclic fold.",
    ),
    "reset": Theorem(
        "Beerens et al., IEEE Trans. Control Systems Technology, 2021",
        "A reset integral settles where PID hunts. The rule here: reversed as the error is zero.",
    ),
    "pendulum": Theorem(
        "Against: Antonio-Cruz et al., Complexity, 2019, whose gains were not available",
        "No state feedback of the Furuta pendulum eliminates the limit cycle.",
    ),
    "compensation": Theorem(
        "Putra, van de Wouw, Nijmeijer, Automatica, 2007",
        "Compensating too little leaves rests; compensating too much leaves a limit cycle.",
    ),
}


def theorem(name: str, loops: int = 100, seed: int = 0) -> dict[str, Any]:
    """The table of a theorem: source, statement, rows, whether they agree, time [s].

    Raises:
        ParameterError: There is no such theorem, or the number of loops is not above 0.
    """
    if name not in THEOREMS:
        raise ParameterError(f"there is no theorem {name}, only {', '.join(THEOREMS)}")
    if loops < 1:
        raise ParameterError(f"the number of loops must be above 0, given {loops}")
    from furuta.axis import theorem_checks

    chosen, start = THEOREMS[name], perf_counter()
    rows, holds = getattr(theorem_checks, name)(loops, seed)
    return {
        "theorem": name,
        "source": chosen.source,
        "statement": chosen.statement,
        "rows": rows,
        "holds": holds,
        "wall_seconds": perf_counter() - start,
    }
