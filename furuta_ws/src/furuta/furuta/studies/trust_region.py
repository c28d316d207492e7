"""The search without derivatives that tuning and comparison share."""

from collections.abc import Callable, Sequence

import numpy as np
import scipy

# COBYQA needs fewer evaluations; scipy has it since 1.14, and Ubuntu 24.04 has scipy 1.11.
SEARCH = "COBYQA" if tuple(map(int, scipy.__version__.split(".")[:2])) >= (1, 14) else "COBYLA"


def search(
    cost: Callable[[np.ndarray], float],
    start: np.ndarray,
    radii: tuple[float, float],
    evaluations: int,
    bounds: Sequence[tuple[float, float]] | None = None,
) -> None:
    """Call ``cost`` at most so often, near its minimum in the end; ``radii`` of the trust region.

    The caller keeps what it has tried. A point may be outside the bounds by rounding.
    """
    from scipy.optimize import minimize

    first, last = radii
    options = {"maxfev": evaluations, "initial_tr_radius": first, "final_tr_radius": last}
    if SEARCH == "COBYLA":
        options = {"maxiter": evaluations, "rhobeg": first, "tol": last}
    minimize(cost, start, method=SEARCH, bounds=bounds, options=options)
