"""Friction as python-control's describing functions take it."""

from control import DescribingFunctionNonlinearity

from furuta.describing_functions.describing_function import describing_function
from furuta_model.friction.laws import FrictionLaw, steady_friction


class FrictionNonlinearity(DescribingFunctionNonlinearity):
    """A friction law; its N is that at ω [rad/s]."""

    def __init__(self, law: FrictionLaw, omega: float) -> None:
        self._law, self._omega = law, omega

    def __call__(self, v: float) -> float:
        """Friction [V] at steady speed v [rad/s]."""
        return steady_friction(v, self._law)

    def describing_function(self, A: float) -> complex:  # noqa: N803
        """N [V s/rad] at v = A sin ωt."""
        return describing_function(A, self._omega, self._law)
