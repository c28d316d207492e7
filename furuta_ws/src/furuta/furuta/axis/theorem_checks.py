"""The checks of the theorems of :mod:`furuta.axis.theorems`, each a function of its name.

It gets the number of random loops and a seed, and returns rows of a table and whether they agree.
"""

from __future__ import annotations

from functools import partial

from furuta.axis.axis import Axis, Pid
from furuta.axis.compensated import compensation_map
from furuta.axis.final_motions import Rows, coulomb_axes, pendulum_feedbacks, static_axes
from furuta.axis.folds import EXAMPLE, GAINS
from furuta.axis.folds import fold as fold_between
from furuta.axis.reset_integral import reset_rows

DAMPINGS = (0.4, 2.5)  # range of k_d in which the fold is looked for

coulomb, stiction, pendulum = coulomb_axes, static_axes, pendulum_feedbacks


def fold(loops: int, seed: int) -> tuple[Rows, bool]:
    """The folds of the laws Stribeck and LuGre."""
    rows: Rows = []
    for law in ("stribeck", "lugre"):
        found = fold_between(partial(_damped, law), *DAMPINGS)
        if found:
            rows.append({"law": law, "kd": found.value, "peak_to_peak_rad": found.peak_to_peak})
    return rows, len(rows) == 2


def _damped(law: str, kd: float) -> tuple[Axis, Pid]:
    return EXAMPLE._replace(law=law), GAINS._replace(kd=kd)


def reset(loops: int, seed: int) -> tuple[Rows, bool]:
    """Final motions with and without the reset."""
    return reset_rows(EXAMPLE, GAINS)


def compensation(loops: int, seed: int) -> tuple[Rows, bool]:
    """Final motions over the compensated part of friction."""
    return compensation_map()
