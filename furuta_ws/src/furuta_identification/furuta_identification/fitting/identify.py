"""From recordings to a model: preparation, regression, then output error."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.balanced import fit_balanced
from furuta_identification.fitting.first_estimate import first_estimate, starting_values
from furuta_identification.fitting.model import Model
from furuta_identification.fitting.swinging import fit_swinging
from furuta_identification.preparation.options import Options
from furuta_identification.preparation.prepare import prepare
from furuta_identification.regression.speeds import speed_lag
from furuta_model.state import THETA
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import split_into_runs

# Largest pendulum angle [rad] of a pendulum that was balanced.
LARGEST_BALANCED_ANGLE = 0.7


def identify(recordings: list[Recording], options: Options) -> Model:
    """Fit one model to all recordings; raises :class:`ParameterError` if that is impossible."""
    prepared, findings = _prepared_runs(recordings, options)
    lag = float(np.median([speed_lag(each) for each in prepared]))
    prepared, regression, delay, negated = first_estimate(prepared, lag)
    if negated:
        findings.append("a positive command turns the arm in its negative direction: sign inverted")
    start = starting_values(regression, lag)
    if all(np.max(np.abs(each.measured[:, THETA])) < LARGEST_BALANCED_ANGLE for each in prepared):
        # In such slow motion the regression hardly distinguishes a delay from an inertia.
        model, delay = fit_balanced(prepared, start, regression, findings, options), 0.0
    else:
        delayed = [each.with_delayed_command(delay) for each in prepared]
        model = fit_swinging(delayed, start, regression, findings, options)
    return model._replace(command_negated=negated, command_delay=delay)


def _prepared_runs(
    recordings: list[Recording], options: Options
) -> tuple[list[Recording], list[str]]:
    """All runs of all recordings, ready for a fit, and what was found."""
    prepared, findings = [], []
    for recording in recordings:
        runs, found = split_into_runs(recording)
        findings += found
        for run in runs:
            ready, found = prepare(run, options)
            prepared.append(ready)
            findings += found
    return prepared, findings
