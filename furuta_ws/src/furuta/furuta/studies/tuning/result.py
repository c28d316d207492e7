"""The result of a tuning, as values, as JSON and as a parameter file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import yaml

from furuta_friction.compensation import ObserverParameters
from furuta_model.friction.parameters import Friction
from furuta_model.parameters import values


class Trial(NamedTuple):
    """One candidate and the arm's peak-to-peak angle [rad] with it."""

    observer: ObserverParameters
    amplitude: float


class TuningResult(NamedTuple):
    """Start and result with their amplitudes, the friction fit, all trials, pendulum time [s].

    ``before`` is the LuGre compensator with the initial parameters, ``uncompensated`` the motion
    without compensation, and ``given`` that with the initial compensation. ``fitted`` is None if no
    friction was observed.
    """

    before: Trial
    uncompensated: Trial
    given: Trial
    fitted: Friction | None
    after: Trial
    trials: list[Trial]
    seconds: float

    @property
    def gain(self) -> bool:
        """Whether tuning found something better than the initial parameters and than none."""
        return self.after not in (self.before, self.uncompensated, self.given)


def result_as_json(result: TuningResult) -> dict[str, Any]:
    """The result as a JSON object."""
    return {
        "parameters": observer_parameters(result.after.observer),
        "before": _trial(result.before),
        "uncompensated": _trial(result.uncompensated),
        "given": _trial(result.given),
        "after": _trial(result.after),
        "gain": result.gain,
        "fitted": result.fitted and dict(result.fitted._asdict()),
        "trials": [_trial(trial) for trial in result.trials],
        "pendulum_seconds": result.seconds,
    }


def observer_parameters(observer: ObserverParameters) -> dict[str, Any]:
    """The friction observer's parameters that can be set while it runs."""
    return {name: each for name, each in values(observer).items() if name != "sample_time"}


def write_parameter_file(observer: ObserverParameters, path: Path) -> None:
    """Write a ROS parameter file that the friction observer can load."""
    content = {"friction_observer": {"ros__parameters": observer_parameters(observer)}}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(yaml.safe_dump(content, sort_keys=False))


def _trial(trial: Trial) -> dict[str, Any]:
    return {
        "phi_peak_to_peak_rad": trial.amplitude,
        "parameters": observer_parameters(trial.observer),
    }
