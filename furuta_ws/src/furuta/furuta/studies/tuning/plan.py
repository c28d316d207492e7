"""The plan of a tuning: which parameters, how much pendulum time, which guard."""

from typing import NamedTuple

from furuta.studies.tuning.observed_friction import FITTED
from furuta_model.parameters import ParameterError

# Pendulum time [s] of a trial: transients, then the measurement of the amplitude.
SETTLING_TIME = 2.0
MEASURING_TIME = 10.0
# Pendulum time [s] without compensation: transients, then the recording of the friction.
FRICTION_SETTLING_TIME = 3.0
FRICTION_RECORDING_TIME = 12.0
# Pendulum time without guard after a candidate that left the guard [s].
RECOVERY_TIME = 3.0
# Compensations that are tried with the fitted friction, besides the LuGre observer.
RIVALS = ("coulomb", "stiction", "adaptive")
# Number of best candidates that are measured once more, and the least time [s] for each.
FINALISTS = 3
FINAL_MEASURING_TIME = 12.0


class TuningPlan(NamedTuple):
    """Which parameters are tuned, for how long, and within which guard.

    ``fit`` are fitted to the observed friction, ``search`` are then found by trials of the LuGre
    compensator; ``rivals`` are other compensations, tried once if there is time. ``seconds`` [s] is
    the total pendulum time, ``arm_guard`` [rad] the largest allowed peak-to-peak angle of the arm
    and ``pendulum_guard`` [rad] the largest allowed angle of the pendulum.
    """

    fit: tuple[str, ...] = FITTED
    search: tuple[str, ...] = ("sigma1",)
    seconds: float = 200.0
    arm_guard: float = 1.0
    pendulum_guard: float = 0.4
    rivals: tuple[str, ...] = ()

    def check(self) -> None:
        """Reject a time that is too short."""
        if self.seconds < self.min_seconds:
            raise ParameterError(
                f"needs at least {self.min_seconds:g} s of pendulum time, given {self.seconds:g}"
            )

    @property
    def max_trials(self) -> int:
        """Number of candidates for which the search has time."""
        left = self.seconds - self._seconds_besides_search - self.seconds_for_rivals
        return int(left // (SETTLING_TIME + MEASURING_TIME))

    @property
    def min_seconds(self) -> float:
        """The least pendulum time [s]: a search over n parameters starts with 2n + 1 candidates."""
        trials = 2 * len(self.search) + 1
        return self._seconds_besides_search + trials * (SETTLING_TIME + MEASURING_TIME)

    @property
    def _seconds_besides_search(self) -> float:
        friction = FRICTION_SETTLING_TIME + FRICTION_RECORDING_TIME
        final = FINALISTS * (SETTLING_TIME + FINAL_MEASURING_TIME)
        return friction + SETTLING_TIME + MEASURING_TIME + final

    @property
    def seconds_for_rivals(self) -> float:
        """Pendulum time [s] for one trial of each of the rivals; 0 if there is not enough."""
        needed = len(self.rivals) * (SETTLING_TIME + MEASURING_TIME)
        return needed if self.seconds >= self.min_seconds + needed else 0.0


# For a simulation: the arm may move far; a pendulum beyond 1.5 rad has fallen.
SIMULATED = TuningPlan(arm_guard=100.0, pendulum_guard=1.5)
