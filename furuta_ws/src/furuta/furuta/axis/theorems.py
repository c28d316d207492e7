"""Theorems on friction and limit cycles, each with its source and what the engine finds.

Of the papers only the abstracts were read. Nothing is claimed of them beyond the statements here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import Any, NamedTuple

from furuta.axis.axis import Axis, Pid
from furuta.axis.compensated import compensation_map
from furuta.axis.final_motions import Rows, coulomb_axes, pendulum_feedbacks, static_axes
from furuta.axis.folds import EXAMPLE, GAINS, fold
from furuta.axis.reset_integral import reset_rows
from furuta_model.parameters import ParameterError

DAMPINGS = (0.4, 2.5)  # range of k_d in which the fold is looked for


class Theorem(NamedTuple):
    """Source, statement, and what checks it: rows of a table, and whether they agree.

    ``check`` gets the number of random loops and a seed.
    """

    source: str
    statement: str
    check: Callable[[int, int], tuple[Rows, bool]]


def _folds(loops: int, seed: int) -> tuple[Rows, bool]:
    rows: Rows = []
    for law in ("stribeck", "lugre"):
        found = fold(partial(_damped, law), *DAMPINGS)
        if found:
            rows.append({"law": law, "kd": found.value, "peak_to_peak_rad": found.peak_to_peak})
    return rows, len(rows) == 2


def _damped(law: str, kd: float) -> tuple[Axis, Pid]:
    return EXAMPLE._replace(law=law), GAINS._replace(kd=kd)


THEOREMS = {
    "coulomb": Theorem(
        "Bisoffi, Da Lio, Teel, Zaccarian, IEEE Trans. Automatic Control 63(8), 2018",
        "Under Coulomb friction alone every stabilising PID brings the axis to rest.",
        coulomb_axes,
    ),
    "stiction": Theorem(
        "Armstrong, Amin, Automatica 32(5), 1996",
        "With static friction above Coulomb's every stabilising PID hunts.",
        static_axes,
    ),
    "fold": Theorem(
        "Hensen, van de Molengraft, Steinbuch, Friction induced limit cycling: hunting",
        "With Stribeck and LuGre friction hunting disappears beyond the gain of a cyclic fold.",
        _folds,
    ),
    "reset": Theorem(
        "Beerens et al., IEEE Trans. Control Systems Technology, 2021",
        "A reset integral settles where PID hunts. The rule here: reversed as the error is zero.",
        lambda loops, seed: reset_rows(EXAMPLE, GAINS),
    ),
    "pendulum": Theorem(
        "Against: Antonio-Cruz et al., Complexity, 2019, whose gains were not available",
        "No state feedback of the Furuta pendulum eliminates the limit cycle.",
        pendulum_feedbacks,
    ),
    "compensation": Theorem(
        "Putra, van de Wouw, Nijmeijer, Automatica, 2007",
        "Compensating too little leaves rests; compensating too much leaves a limit cycle.",
        lambda loops, seed: compensation_map(),
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
    chosen, start = THEOREMS[name], perf_counter()
    rows, holds = chosen.check(loops, seed)
    return {
        "theorem": name,
        "source": chosen.source,
        "statement": chosen.statement,
        "rows": rows,
        "holds": holds,
        "wall_seconds": perf_counter() - start,
    }
