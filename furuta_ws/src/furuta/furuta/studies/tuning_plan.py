"""The plan of a tuning: how much pendulum time, and which guard."""

from typing import NamedTuple

from furuta_model.parameters import ParameterError

# Pendulum time [s] before the first trial. Of a trial: transients, then the measurement, which must
# cover slow and irregular motion; further for a swing that is near, or the best one; after a trial
# that is given up, at most so often.
STARTING, SETTLING, MEASURING, CONFIRMING, RECOVERY, CALM = 8.0, 2.0, 6.0, 16.0, 2.0, 4
GUARD_INTERVAL = 0.1
# Longest trial: one whose motion decays, and is then given up.
LONGEST = SETTLING + 2.0 * MEASURING + CALM * RECOVERY
LEAST_SECONDS = STARTING + 3.0 * (SETTLING + MEASURING + RECOVERY) + SETTLING + CONFIRMING


class TuningPlan(NamedTuple):
    """For how long a loop is tuned, and within which guard.

    ``seconds`` [s] is the most pendulum time, ``arm_guard`` [rad] the largest allowed peak-to-peak
    angle of the arm and ``pendulum_guard`` [rad] the largest allowed angle of the pendulum. A swing
    of ``enough`` counts of the encoder ends the search.
    """

    seconds: float = 120.0
    arm_guard: float = 1.0
    pendulum_guard: float = 0.4
    enough: float = 1.0

    def check(self) -> None:
        """Reject a time that is too short."""
        if self.seconds < LEAST_SECONDS:
            raise ParameterError(
                f"needs at least {LEAST_SECONDS:g} s of pendulum time, given {self.seconds:g}"
            )
