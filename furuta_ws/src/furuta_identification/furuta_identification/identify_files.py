"""Identification of files: reads them, fits a model, and predicts what was fitted and held out."""

from pathlib import Path
from typing import NamedTuple

from furuta_identification.identify import identify
from furuta_identification.model import Model, Prediction
from furuta_identification.options import Options
from furuta_identification.result.validation import validate
from furuta_recordings.readers import Mapping, read
from furuta_recordings.recording import Recording
from furuta_recordings.splitting import split_into_runs


class Identified(NamedTuple):
    """A model, its predictions of fitted and of held-out recordings, and findings of reading."""

    model: Model
    fitted: list[Prediction]
    held_out: list[Prediction]
    findings: list[str]


def identify_files(
    paths: tuple[Path, ...], validation_paths: tuple[Path, ...], names: Mapping, options: Options
) -> Identified:
    """Fit a model to the recordings at ``paths`` and validate it on the others."""
    recordings, findings = _read_all(paths, names)
    model = identify(recordings, options)
    held_out = []
    others, remarks = _read_all(validation_paths, names)
    findings += remarks
    for recording in others:
        for run in split_into_runs(recording)[0]:
            prediction, remarks = validate(model, run, options)
            held_out.append(prediction)
            findings += remarks
    fitted = [model.predict(recording) for recording in model.recordings]
    return Identified(model, fitted, held_out, findings)


def _read_all(paths: tuple[Path, ...], names: Mapping) -> tuple[list[Recording], list[str]]:
    """The recordings, each with a unique name, and how their content was interpreted."""
    recordings, findings = [], []
    for path in paths:
        recording, remarks = read(path, names)
        ambiguous = sum(other.name == path.name for other in paths) > 1
        recordings.append(recording._replace(name=str(path)) if ambiguous else recording)
        findings += remarks
    return recordings, findings
