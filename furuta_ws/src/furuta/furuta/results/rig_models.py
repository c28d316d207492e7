"""What recordings tell of a rig: a model with its verdict, or the pendulum's own motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from furuta.identification.fitting import free_swing
from furuta.identification.fitting.friction_laws import LawResult, simplest_adequate_law
from furuta.identification.model import Model, Prediction
from furuta.identification.result.identified_rig import base_rig, write_rig
from furuta.identification.result.rig_friction import rig_friction
from furuta.identification.result.values import coloured, fits, values_by_name, verdict_on
from furuta.identification.verdict import Verdict
from furuta.results.identified import JointFit, findings_text, verdict_sentence
from furuta.results.result import Found
from furuta.results.text import values_text
from furuta_hw.rigs.rig import Rig
from furuta_recordings.recording import findings_of

# A value that another one repeats.
SAME_AS_COULOMB = "alpha0"


class RigModel(Found):
    """A model of pendulum and friction that was fitted to recordings, as :meth:`to_dict` has it.

    Attributes:
        held_out: What the model predicts of recordings that it was not fitted to.
        laws: How well other laws of the arm's friction predict, if they were compared.
    """

    found: Model
    # Values are shown with those of other groups, findings last.
    details = frozenset({"lugre", "setup", "window_s", "coloured_percent", "usable", "reasons"})

    def __init__(
        self,
        found: Model,
        held_out: Iterable[Prediction] = (),
        laws: Sequence[LawResult] = (),
    ) -> None:
        super().__init__(found)
        self.held_out, self.laws = list(held_out), list(laws)

    @cached_property
    def fitted(self) -> list[Prediction]:
        """What the model predicts of its own recordings."""
        return [self.found.predict(recording) for recording in self.found.recordings]

    @cached_property
    def _values(self) -> dict[str, Any]:
        """The values by name; their errors take long, with slopes in all unknowns."""
        return values_by_name(self.found)

    @cached_property
    def verdict(self) -> Verdict:
        """Whether the model is usable, and why not."""
        return verdict_on(self.found, self.fitted)

    def _by_name(self) -> dict[str, Any]:
        """Values with ``standard_errors`` and ``units`` by name, fits [%], verdict, findings.

        A value is None if the data do not determine it; ``undetermined`` has the reason.
        """
        values = dict(self._values)
        findings = values.pop("findings") + findings_of([run.recording for run in self.held_out])
        if self.laws:
            values["friction_laws"] = self.laws
            values["simplest_adequate_law"] = simplest_adequate_law(self.laws).law
        return {
            **values,
            "fit": {run.recording.name: fits(run) for run in self.fitted},
            "held_out": {run.recording.name: fits(run) for run in self.held_out},
            **self.verdict._asdict(),
            "coloured_percent": {run.recording.name: coloured(run) for run in self.fitted},
            "findings": list(dict.fromkeys(findings)),
        }

    def sentence(self) -> str:
        """Whether the model is usable, and the law that suits its friction."""
        text = verdict_sentence(self.verdict, "model")
        if not self.laws:
            return text
        return f"{text} The data support the law {simplest_adequate_law(self.laws).law}."

    def table(self, values: Mapping[str, Any]) -> str:
        """The values with their errors, fits, waves and laws as tables, then what was found."""
        one_by_one = {**values, **self._values["lugre"], **self._values["setup"]}
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
        base, findings = base_rig(self.found, base, source)
        write_rig(self.found, Path(path), base, findings, self.verdict)
        return findings

    def plot(self, axes: Any = None) -> Any:
        """Draw the friction, and the recordings as measured and fitted; see :meth:`Result.plot`."""
        from furuta.figures.residual import draw_rig_model

        return draw_rig_model(rig_friction(self.found), self.fitted, self.held_out, axes)


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


class FreeSwing(JointFit):
    """The pendulum's own motion: ``values`` and ``standard_errors`` by name, divided by β."""

    found: free_swing.FreeSwing
    details = JointFit.details | {"coloured_percent"}

    def _by_name(self) -> dict[str, Any]:
        """Values by name, standard errors, fit of the angle [%], verdict and findings."""
        runs = {run.recording.name: run for run in self.found.predictions}
        return {
            **super()._by_name(),
            "fit": {name: run.fits()["pendulum angle"] for name, run in runs.items()},
            "coloured_percent": {name: coloured(run) for name, run in runs.items()},
        }

    def plot(self, axes: Any = None) -> Any:
        """Draw the recordings, measured and fitted; see :meth:`Result.plot`."""
        from furuta.figures.residual import draw_residuals

        return draw_residuals(self.found.predictions, [], axes)
