"""Order of the state everywhere: x = (φ, φ̇, θ, θ̇), then the bristle deflection z of the plant.

φ is the arm's angle [rad], θ the pendulum's [rad], zero upright. Between the members of the loop
the arm's torque follows x instead: in a measurement the one that the drive applied since the
last sample, in an estimate the friction; NaN where it is not known.
"""

from typing import Final

PHI: Final = 0
PHI_DOT: Final = 1
THETA: Final = 2
THETA_DOT: Final = 3
BRISTLE: Final = 4
EFFORT: Final = 4

RIGID_STATES: Final = 4
PLANT_STATES: Final = 5
SIGNALS: Final = 5
