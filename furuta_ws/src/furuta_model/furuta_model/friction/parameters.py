"""Parameters of friction, shared by all laws."""

from typing import Annotated, NamedTuple

from furuta_model.parameters import About

# Smallest level [V], so that the rate of the bristle stays finite without friction.
SMALLEST_LEVEL = 1e-12


class Friction(NamedTuple):
    """Parameters of the friction laws. Defaults: the paper's values for LuGre, Fig. 8.

    The paper does not give a Stribeck velocity. 0.05 rad/s is a tenth of the speed in the limit
    cycle, so α₁ acts only at reversals, like stiction.
    """

    sigma0: Annotated[float, About("bristle stiffness σ₀", "V/rad", 1e-3, 1e9)] = 80.0
    sigma1: Annotated[float, About("bristle damping σ₁", "V s/rad", 0.0, 1e6)] = 1.5
    alpha0: Annotated[float, About("Coulomb level α₀", "V", 0.0, 1e5)] = 0.21
    alpha1: Annotated[float, About("stiction α₁ above the Coulomb level", "V", 0.0, 1e5)] = 0.022
    stribeck_velocity: Annotated[float, About("Stribeck velocity", "rad/s", 1e-6, 100.0)] = 0.05
    viscous: Annotated[float, About("viscous friction σ₂", "V s/rad", 0.0, 1e5)] = 0.0
    asymmetry: Annotated[
        float,
        About("level times 1 + asymmetry for v > 0, times 1 - asymmetry for v < 0", "", -1, 1),
    ] = 0.0
