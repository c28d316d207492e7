"""Torque that varies with the arm's angle: several waves, as ``furuta identify`` finds them.

The torque Σ aₖ cos nₖφ + bₖ sin nₖφ is added to that of the drive. Order 1 is an unbalanced arm on
a tilted base, higher orders are ripple and cogging of the motor.
"""

from math import cos, sin
from typing import Annotated, NamedTuple

import numpy as np

from furuta_model.compiled import inlined
from furuta_model.parameters import About, ParameterError

MAX_WAVES = 16
# Columns of a wave.
ORDER, COSINE, SINE = range(3)

Numbers = tuple[float, ...]


class TorqueWaves(NamedTuple):
    """The waves: three lists of one length."""

    orders: Annotated[Numbers, About("waves per turn of each wave", "", 0, 10_000)] = (0.0,)
    cosine: Annotated[Numbers, About("factor of cos(order φ)", "V", -10, 10)] = (0.0,)
    sine: Annotated[Numbers, About("factor of sin(order φ)", "V", -10, 10)] = (0.0,)

    def check(self) -> None:
        """Reject lists of different lengths, and too many waves."""
        lengths = {name: len(given) for name, given in self._asdict().items()}
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise ParameterError(f"lists of waves must have one length; given {listed}")
        if len(self.orders) > MAX_WAVES:
            raise ParameterError(f"at most {MAX_WAVES} waves are possible, given {lengths}")

    @property
    def table(self) -> np.ndarray:
        """The waves that are not zero (k, 3): order, factors of cosine and sine [V]."""
        waves = [each for each in zip(*self, strict=True) if each[COSINE] or each[SINE]]
        return np.array(waves).reshape(-1, 3)


@inlined
def wave_torque(phi: float, waves: np.ndarray) -> float:
    """Torque [V] of the ``waves`` (k, 3) at arm angle φ [rad]."""
    torque = 0.0
    for k in range(waves.shape[0]):
        angle = waves[k, ORDER] * phi
        torque += waves[k, COSINE] * cos(angle) + waves[k, SINE] * sin(angle)
    return torque
