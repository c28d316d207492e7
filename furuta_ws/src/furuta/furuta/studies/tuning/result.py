"""The result of a tuning, as values, as JSON and as a parameter file."""

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

    def as_json(self) -> dict[str, Any]:
        """The trial as a JSON object."""
        return {
            "phi_peak_to_peak_rad": self.amplitude,
            "parameters": observer_parameters(self.observer),
        }


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

    def as_json(self) -> dict[str, Any]:
        """The result as a JSON object."""
        return {
            "parameters": observer_parameters(self.after.observer),
            "before": self.before.as_json(),
            "uncompensated": self.uncompensated.as_json(),
            "given": self.given.as_json(),
            "after": self.after.as_json(),
            "gain": self.gain,
            "fitted": self.fitted and dict(self.fitted._asdict()),
            "trials": [trial.as_json() for trial in self.trials],
            "pendulum_seconds": self.seconds,
        }

    def print(self) -> None:
        """Print amplitudes and parameters for a reader."""
        lines: dict[str, Any] = {
            "arm, peak to peak, before": f"{self.before.amplitude:.4f} rad",
            "without compensation": f"{self.uncompensated.amplitude:.4f} rad",
            "after": f"{self.after.amplitude:.4f} rad",
            **observer_parameters(self.after.observer),
            "pendulum time": f"{self.seconds:.0f} s",
        }
        for name, value in lines.items():
            print(f"{name:32} {value if isinstance(value, str) else f'{value:.5g}'}")
        if self.after == self.uncompensated:
            print("no gain: nothing is better than no compensation")
        elif not self.gain:
            given = self.after.observer.compensation
            print(f"no gain: nothing is better than the initial parameters of {given}")


def observer_parameters(observer: ObserverParameters) -> dict[str, Any]:
    """The friction observer's parameters that can be set while it runs."""
    return {name: value for name, value in values(observer).items() if name != "sample_time"}


def write_parameter_file(observer: ObserverParameters, path: Path) -> None:
    """Write a ROS parameter file that the friction observer can load."""
    content = {"friction_observer": {"ros__parameters": observer_parameters(observer)}}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(yaml.safe_dump(content, sort_keys=False))
