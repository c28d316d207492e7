"""What a tuning came to, for people and programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from furuta_friction.compensation import ObserverParameters
from furuta_model.parameters import values
from furuta_studies.tuning.tuning import Trial, TuningResult


def described(tuned: TuningResult) -> dict[str, Any]:
    """The tuning as JSON's objects."""
    return {
        "parameters": parameters(tuned.after.observer),
        "before": _trial(tuned.before),
        "after": _trial(tuned.after),
        "fitted": dict(tuned.fitted._asdict()),
        "trials": [_trial(trial) for trial in tuned.trials],
        "pendulum_seconds": tuned.seconds,
    }


def parameters(observer: ObserverParameters) -> dict[str, Any]:
    """The friction observer's parameters that can be set while it runs."""
    return {name: each for name, each in values(observer).items() if name != "sample_time"}


def write_parameter_file(observer: ObserverParameters, path: Path) -> None:
    """A parameter file that the node loads as it is."""
    content = {"friction_observer": {"ros__parameters": parameters(observer)}}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(yaml.safe_dump(content, sort_keys=False))


def _trial(trial: Trial) -> dict[str, Any]:
    return {"phi_peak_to_peak_rad": trial.amplitude, "parameters": parameters(trial.observer)}
