"""A loop that can be tuned, simulated or real, and the guard around it."""

from typing import Protocol

import numpy as np

from furuta_friction.compensation import ObserverParameters
from furuta_model.parameters import ParameterError
from furuta_model.state import PHI, THETA
from furuta_sim.simulation.closed_loop import Loop, Simulation

# Time between two checks of the guard [s].
GUARD_INTERVAL = 0.1


class TunableLoop(Protocol):
    """A closed loop in operation, simulated or real."""

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters."""

    def watch(self, seconds: float) -> np.ndarray:
        """Let the pendulum move on, and return the estimates (n, 5) of that time."""


class SimulatedLoop:
    """A simulation as a :class:`TunableLoop`."""

    def __init__(self, loop: Loop) -> None:
        self._simulation = Simulation(loop)

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters between two samples."""
        self._simulation.loop = self._simulation.loop._replace(observer=observer)

    def watch(self, seconds: float) -> np.ndarray:
        """Continue the simulation, and return the estimates (n, 5)."""
        return self._simulation.run(seconds).estimate


class GuardError(ParameterError):
    """The motion left the guard."""


class GuardedLoop:
    """A loop whose excursion is checked every tenth of a second.

    ``arm_guard`` [rad] is the largest allowed peak-to-peak angle of the arm, ``pendulum_guard``
    [rad] the largest allowed angle of the pendulum; ``elapsed`` is the pendulum time so far [s].
    """

    def __init__(self, loop: TunableLoop, arm_guard: float, pendulum_guard: float) -> None:
        self._loop = loop
        self._arm_guard = arm_guard
        self._pendulum_guard = pendulum_guard
        self.elapsed = 0.0

    def apply(self, observer: ObserverParameters) -> None:
        """Set the friction observer's parameters."""
        self._loop.apply(observer)

    def watch(self, seconds: float) -> np.ndarray:
        """The estimates (n, 5) of the next ``seconds``; :class:`GuardError` outside the guard."""
        low, high = np.inf, -np.inf
        parts = []
        for _ in range(int(seconds / GUARD_INTERVAL + 1e-6)):
            part = self.watch_unguarded(GUARD_INTERVAL)
            parts.append(part)
            low, high = min(low, part[:, PHI].min()), max(high, part[:, PHI].max())
            self._check(high - low, np.abs(part[:, THETA]).max())
        return np.concatenate(parts)

    def watch_unguarded(self, seconds: float) -> np.ndarray:
        """The estimates (n, 5) of the next ``seconds``, without a check."""
        self.elapsed += seconds
        return self._loop.watch(seconds)

    def _check(self, arm: float, pendulum: float) -> None:
        if arm > self._arm_guard or pendulum > self._pendulum_guard:
            raise GuardError(
                f"stopped and restored the initial parameters: arm {arm:.2f} rad peak to peak, "
                f"pendulum {pendulum:.2f} rad; the guard is {self._arm_guard:g} and "
                f"{self._pendulum_guard:g} rad (arm-guard, pendulum-guard)"
            )
