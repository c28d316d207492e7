"""From recordings to a model: preparation, regression, then output error."""

from __future__ import annotations

import numpy as np

from furuta_identification.fitting.balanced import fit_balanced
from furuta_identification.fitting.ceiling import fitted_ceiling, what_hides_a_ceiling
from furuta_identification.fitting.first_estimate import first_estimate, starting_values
from furuta_identification.fitting.model import Model
from furuta_identification.fitting.swinging import fit_swinging
from furuta_identification.fitting.validation import is_balanced
from furuta_identification.preparation.options import Options
from furuta_identification.preparation.prepare import prepare_all
from furuta_identification.regression.speeds import speed_lag
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import excerpts_of, split_into_runs


def identify(recordings: list[Recording], options: Options) -> Model:
    """Fit one model to all recordings; raises :class:`ParameterError` if that is impossible."""
    runs, findings = _runs(recordings, options.most_samples)
    options.report("finding units and orientation")
    ready = prepare_all(runs, options)
    prepared, findings = ready.recordings, [*findings, *ready.findings]
    lag = float(np.median([speed_lag(each) for each in prepared]))
    prepared, regression, delay, negated = first_estimate(prepared, lag)
    if negated:
        findings.append("a positive command turns the arm in its negative direction: sign inverted")
    ceiling = options.ceiling or fitted_ceiling(prepared, lag, delay)
    if np.isfinite(ceiling):
        limited = [each.with_ceiling(ceiling) for each in prepared]
        regression = first_estimate(limited, lag).regression
    else:
        findings += what_hides_a_ceiling(prepared)
    start = starting_values(regression, lag, ceiling)
    if all(is_balanced(each) for each in prepared):
        # In such slow motion the regression hardly distinguishes a delay from an inertia.
        model, delay = fit_balanced(prepared, start, regression, findings, options), 0.0
    else:
        delayed = [each.with_delayed_command(delay) for each in prepared]
        model = fit_swinging(delayed, start, regression, findings, options)
    return model._replace(
        command_negated=negated,
        command_delay=delay,
        angles=ready.angles,
        direction=ready.direction,
    )


def _runs(recordings: list[Recording], most_samples: int) -> tuple[list[Recording], list[str]]:
    """Excerpts of all runs of all recordings, and what was found."""
    runs, findings = [], []
    for recording in recordings:
        own, found = split_into_runs(recording)
        runs += own
        findings += found
    chosen = []
    for number, run in enumerate(runs):
        excerpts, found = excerpts_of(run._replace(number=number), most_samples // len(runs))
        chosen += excerpts
        findings += found
    return chosen, findings
