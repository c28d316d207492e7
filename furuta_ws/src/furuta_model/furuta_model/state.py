"""Names the indices of the state and of the signals of the loop.

The state is x = (φ, φ̇, θ, θ̇) everywhere: arm angle and speed, pendulum angle (zero upright) and
speed [rad, rad/s]. Three arrays (5,) begin with x and differ in the fifth number:

=============  ==================================  =============================================
array          index                               meaning of the fifth number
=============  ==================================  =============================================
plant state    :data:`BRISTLE`                     memory of the friction law: deflection of the
                                                   bristle or mean deflection of the springs
                                                   [rad], or the friction [V] of a law that
                                                   truly sticks
measurement    :data:`APPLIED_TORQUE`              torque applied since the last measurement [V]
estimate       :data:`APPLIED_TORQUE`              the same
=============  ==================================  =============================================

NaN marks a value that is not measured or not estimated.
"""

from math import pi
from typing import Final

import numpy as np

from furuta_model.compiled import inlined

PHI: Final = 0
PHI_DOT: Final = 1
THETA: Final = 2
THETA_DOT: Final = 3
RIGID_STATES: Final = 4

BRISTLE: Final = 4
PLANT_STATES: Final = 5

APPLIED_TORQUE: Final = 4
# Inside an estimator, and for an own compensator: the friction that is observed [V].
OBSERVED_FRICTION: Final = 4
SIGNALS: Final = 5
# Names of a measurement's signals, for messages.
SIGNAL_NAMES: Final = (
    "arm angle",
    "arm speed",
    "pendulum angle",
    "pendulum speed",
    "applied torque",
)
# Index in a message: effort of the arm.
EFFORT: Final = 4

# The pendulum counts as fallen beyond this angle [rad].
HORIZONTAL: Final = 0.5 * pi
# No sensor, drive or estimate gives a larger value [rad, rad/s, V].
LARGEST_VALUE: Final = 1e6


@inlined
def is_possible(x: np.ndarray) -> bool:
    """Whether no number of ``x`` is larger than that; NaN may be one."""
    for value in x:  # noqa: SIM110 (numba compiles no generators)
        if abs(value) > LARGEST_VALUE:
            return False
    return True
