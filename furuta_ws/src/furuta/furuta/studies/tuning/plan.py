"""The plan of a tuning, how much pendulum time and which guard, and its result."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from furuta_model.parameters import ParameterError, values

if TYPE_CHECKING:
    from furuta_friction.compensation import ObserverParameters

# Pendulum time [s] of a trial: transients, then the measurement of the amplitude.
SETTLING_TIME = 2.0
MEASURING_TIME = 10.0
TRIAL_TIME = SETTLING_TIME + MEASURING_TIME
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
# Pendulum time [s] beside the search, and the least time: the search starts with 3 candidates.
_BESIDES_SEARCH = (
    FRICTION_SETTLING_TIME
    + FRICTION_RECORDING_TIME
    + TRIAL_TIME
    + FINALISTS * (SETTLING_TIME + FINAL_MEASURING_TIME)
)
MIN_SECONDS = _BESIDES_SEARCH + 3 * TRIAL_TIME


class TuningPlan(NamedTuple):
    """For how long a loop is tuned, and within which guard.

    ``seconds`` [s] is the total pendulum time, ``arm_guard`` [rad] the largest allowed peak-to-peak
    angle of the arm and ``pendulum_guard`` [rad] the largest allowed angle of the pendulum. With
    ``rivals`` other compensations than LuGre are tried once, if there is time.
    """

    seconds: float = 200.0
    arm_guard: float = 1.0
    pendulum_guard: float = 0.4
    rivals: bool = False

    def check(self) -> None:
        """Reject a time that is too short."""
        if self.seconds < MIN_SECONDS:
            raise ParameterError(
                f"needs at least {MIN_SECONDS:g} s of pendulum time, given {self.seconds:g}"
            )

    @property
    def max_trials(self) -> int:
        """Number of candidates for which the search has time."""
        rivals = len(RIVALS) * TRIAL_TIME if self.tries_rivals else 0.0
        return int((self.seconds - _BESIDES_SEARCH - rivals) // TRIAL_TIME)

    @property
    def tries_rivals(self) -> bool:
        """Whether other compensations are to be tried, and there is time for it."""
        return self.rivals and self.seconds >= MIN_SECONDS + len(RIVALS) * TRIAL_TIME


# For a simulation: the arm may move far; a pendulum beyond 1.5 rad has fallen.
SIMULATED = TuningPlan(arm_guard=100.0, pendulum_guard=1.5)


class Trial(NamedTuple):
    """One candidate and the arm's peak-to-peak angle [rad] with it."""

    observer: ObserverParameters
    amplitude: float

    def as_json(self) -> dict[str, Any]:
        """The trial as a JSON object."""
        return {
            "phi_peak_to_peak_rad": self.amplitude,
            "parameters": observer_parameters(self.observer),
        }


class TuningResult(NamedTuple):
    """Start and result with their amplitudes, all trials of the search, pendulum time [s].

    ``before`` is the LuGre compensator with the initial parameters, ``uncompensated`` the motion
    without compensation, and ``given`` that with the initial compensation.
    """

    before: Trial
    uncompensated: Trial
    given: Trial
    after: Trial
    trials: list[Trial]
    seconds: float

    @property
    def gain(self) -> bool:
        """Whether tuning found something better than the initial parameters and than none."""
        return self.after not in (self.before, self.uncompensated, self.given)

    def as_json(self) -> dict[str, Any]:
        """The result as a JSON object."""
        return {
            "parameters": observer_parameters(self.after.observer),
            "before": self.before.as_json(),
            "uncompensated": self.uncompensated.as_json(),
            "after": self.after.as_json(),
            "gain": self.gain,
            "pendulum_seconds": self.seconds,
            "search": search_method(),
        }


def observer_parameters(observer: ObserverParameters) -> dict[str, Any]:
    """The friction observer's parameters that can be set while it runs."""
    return {name: value for name, value in values(observer).items() if name != "sample_time"}


def search_method() -> str:
    """Scipy's search; COBYQA needs fewer evaluations, but scipy 1.11 of Ubuntu 24.04 lacks it."""
    import scipy

    version = tuple(map(int, scipy.__version__.split(".")[:2]))
    return "COBYQA" if version >= (1, 14) else "COBYLA"
