"""An axis whose friction truly sticks, as a body: its position under a torque."""

from __future__ import annotations

import numpy as np

from furuta.identification.axis.motion import AxisModel
from furuta.identification.axis.slopes import positions_and_slopes
from furuta.identification.bodies.body import Segments
from furuta.identification.unknowns import Key, Unknowns, Values

# What does not act.
NOTHING: Values = {field: float(field == "stribeck_velocity") for field in AxisModel._fields[:-2]}


def model_of(values: Values) -> AxisModel:
    """The model with these values, those of waves and offsets among them; all others are 0."""
    fields = {str(key): value for key, value in NOTHING.items()}
    offsets: dict[int, float] = {}
    waves: dict[int, list[float]] = {}
    for key, value in values.items():
        if isinstance(key, str):
            fields[key] = value
        elif key[0] == "offset":
            offsets[key[1]] = value
        else:
            waves.setdefault(key[1], [0.0, 0.0])[key[0] == "sin"] = value
    rows = [(order, *wave) for order, wave in sorted(waves.items()) if any(wave)]
    return AxisModel(
        **fields,
        offsets=np.array([offsets[number] for number in sorted(offsets)]),
        waves=np.array(rows, dtype=float).reshape(-1, 3),
    )


def wave(order: int) -> tuple[Key, Key]:
    """The amplitudes of the torque's cosine and sine with so many waves per turn."""
    return ("cos", order), ("sin", order)


class Axis:
    """Positions of an axis; their slopes are carried along with the motion."""

    speed: int | None = 1

    def outputs(self, values: Values, first: np.ndarray, cut: Segments) -> np.ndarray:
        """Positions (n, 1)."""
        positions, _ = positions_and_slopes(model_of(values), first, cut, ())
        return positions[:, None]

    def slopes(
        self, values: Values, first: np.ndarray, cut: Segments, unknowns: Unknowns
    ) -> tuple[np.ndarray, np.ndarray]:
        """Slopes in the unknowns (n, 1, p) and in position and speed of each segment (n, 1, 2)."""
        _, slopes = positions_and_slopes(model_of(values), first, cut, (*unknowns.keys, "q", "v"))
        return slopes[:, None, :-2], slopes[:, None, -2:]
