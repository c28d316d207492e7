"""What recordings tell of a rig: a model with its verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from furuta.identification.estimates import Estimates, findings_text
from furuta.identification.fitting.friction_laws import LawResult, simplest_adequate_law
from furuta.identification.identify import held_out
from furuta.identification.model import Model, Prediction
from furuta.identification.options import Options
from furuta.identification.result.identified_rig import base_rig, write_rig
from furuta.identification.result.rig_friction import rig_friction
from furuta.identification.result.values import (
    UNITS,
    coloured,
    fits,
    reported_values,
    residuals,
    values_by_name,
    verdict_on,
)
from furuta.identification.unknowns import name_of
from furuta.identification.verdict import Residual
from furuta.results.text import values_text
from furuta_hw.rigs.rig import Rig
from furuta_model.state import RIGID_STATES
from furuta_recordings.recording import Recording, findings_of

# A value that another one repeats.
SAME_AS_COULOMB = "alpha0"


@dataclass(frozen=True, repr=False, eq=False)
class RigModel(Estimates):
    """A model of pendulum and friction that was fitted to recordings, as :meth:`to_dict` has it.

    ``names`` and ``covariance`` (p, p) are those of all unknowns, of which positive ones are
    logarithms. ``residual`` is what the model leaves of the joint that it follows worst. ``fitted``
    is what it predicts of its own recordings, ``held_out`` of recordings that it was not fitted to.
    ``laws`` say how well other laws of the arm's friction predict, if they were compared.
    """

    names: tuple[str, ...] = field(repr=False)
    covariance: np.ndarray = field(repr=False)
    residual: Residual
    fitted: list[Prediction] = field(repr=False)
    held_out: list[Prediction] = field(repr=False)
    laws: list[LawResult] = field(repr=False)
    model: Model = field(repr=False)
    groups: dict[str, Any] = field(repr=False)

    # Values are shown with those of other groups, findings last.
    details = Estimates.details | {"lugre", "setup", "window_s", "coloured_percent"}

    def predict(self, recording: Recording) -> np.ndarray:
        """Positions and speeds x (n, 4) at the times of a recording, in rad and rad/s.

        A run gets the command, but of a pendulum that swings the measured state only at its start.
        The pendulum is upright at 0. NaN in pauses between runs.
        """
        predicted = np.full((len(recording.time), RIGID_STATES), np.nan)
        for run in held_out(self.model, [recording], Options()):
            time = run.recording.time
            there = (recording.time >= time[0]) & (recording.time <= time[-1])
            for column, own in zip(predicted.T, run.predicted.T, strict=True):
                column[there] = np.interp(recording.time[there], time, own)
        return predicted

    def _by_name(self) -> dict[str, Any]:
        """Values with ``standard_errors`` and ``units`` by name, fits [%], verdict, findings.

        A value is None if the data do not determine it; ``undetermined`` has the reason.
        """
        values = {**self.groups, "residual": self.residual._asdict()}
        if self.laws:
            values["friction_laws"] = self.laws
            values["simplest_adequate_law"] = simplest_adequate_law(self.laws).law
        return {
            **values,
            "fit": {run.recording.name: fits(run) for run in self.fitted},
            "held_out": {run.recording.name: fits(run) for run in self.held_out},
            **self.verdict._asdict(),
            "coloured_percent": {run.recording.name: coloured(run) for run in self.fitted},
            "findings": self.findings,
        }

    def sentence(self) -> str:
        """Whether the model is usable, and the law that suits its friction."""
        text = self.verdict.about("model")
        if not self.laws:
            return text
        return f"{text} The data support the law {simplest_adequate_law(self.laws).law}."

    def table(self, values: Mapping[str, Any]) -> str:
        """The values with their errors, fits, waves and laws as tables, then what was found."""
        one_by_one = {**values, **self.groups["lugre"], **self.groups["setup"]}
        kinds = {name: isinstance(each, float) for name, each in one_by_one.items()}
        beside = {name: values[name] for name in ("standard_errors", "units")}
        rest = {
            "undetermined": values["undetermined"],
            "fit [%]": _rows(values["fit"]),
            "held out [%]": _rows(values["held_out"]),
            "torque waves [V]": _waves(values["waves"]),
            "held-out error over Coulomb's": _laws(values.get("friction_laws", ())),
        }
        known = {n: each for n, each in one_by_one.items() if kinds[n] and n != SAME_AS_COULOMB}
        text = f"{values_text({**known, **beside})}\n{values_text(rest)}"
        return f"{text}\n\n{findings_text(values['findings'])}"

    def write(
        self, path: str | Path, base: Rig | None = None, source: str | Path | None = None
    ) -> list[str]:
        """Write a rig file, for ``--rig`` and :func:`furuta.load_rig`.

        Args:
            path: The file.
            base: The rig that has the sensors, the line and the limits; by default as ``source``
                has it, or the paper's.
            source: The bag of the first recording, which may tell them.

        Returns:
            Where sensors, line and limits come from.

        Raises:
            ParameterError: The model is not usable.
        """
        self.verdict.require()
        base, findings = base_rig(self.model, base, source)
        write_rig(self.model, Path(path), base, findings, self.verdict)
        return findings

    def plot(self, axes: Any = None) -> Any:
        """Draw the friction, and the recordings as measured and fitted; see :meth:`Result.plot`."""
        from furuta.figures.residual import draw_rig_model

        return draw_rig_model(rig_friction(self.model), self.fitted, self.held_out, axes)


def rig_model(model: Model, held_out: list[Prediction], laws: Sequence[LawResult] = ()) -> RigModel:
    """What a model tells, and how well it predicts."""
    groups, known = values_by_name(model), reported_values(model)
    findings = [*groups.pop("findings"), *findings_of([run.recording for run in held_out])]
    errors = {name: error for name, error in groups["standard_errors"].items() if error}
    fitted = [model.predict(recording) for recording in model.recordings]
    left = [residual for *_, residual in residuals(fitted)]
    return RigModel(
        {name: known[name] for name in errors},
        errors,
        groups["undetermined"],
        {name: UNITS[name] for name in errors if name in UNITS},
        verdict_on(model, fitted),
        list(dict.fromkeys(findings)),
        tuple(map(name_of, model.keys)),
        model.covariance,
        max(left, key=lambda each: each.part),
        fitted,
        held_out,
        list(laws),
        model,
        groups,
    )


def _rows(of_recordings: Mapping[str, Mapping[str, float]]) -> list[dict[str, Any]]:
    return [
        {"recording": name, **{title.replace("_", " "): each for title, each in row.items()}}
        for name, row in of_recordings.items()
    ]


def _waves(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    known = [row for row in rows if None not in (row["cos"], row["sin"])]
    return [
        {"per turn": row["order"], "size": float(np.hypot(row["cos"], row["sin"]))} for row in known
    ]


def _laws(laws: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    return [{"law": law["law"], "parameters": law["parameters"], **law["errors"]} for law in laws]
