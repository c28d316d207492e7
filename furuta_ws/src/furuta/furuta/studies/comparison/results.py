"""The files of a comparison, in a directory with which a killed comparison continues.

``runs.csv`` has a row per run, ``rigs.csv`` the true parameters of each rig, ``tuning.json`` the
tuned candidates, ``summary.json`` the scores.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Container, Iterator
from pathlib import Path
from typing import Any

from furuta.studies.comparison.candidates import Candidate
from furuta.studies.comparison.comparison import Comparison, rig_rows
from furuta.studies.comparison.tuning import TunedCandidate, Tuning
from furuta.studies.study_tables import write_csv
from furuta.studies.sweep import RunResult
from furuta.studies.sweep_journal import Journal
from furuta_model.parameters import ParameterError

# Runs what is not done, and reports each result to a callback.
Runner = Callable[[Comparison, Container[int]], Iterator[RunResult]]
Observer = Callable[[Iterator[RunResult], int, int], None]


class Results:
    """The results of a comparison in a directory that holds no complete one yet."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self.figure = directory / "comparison.png"
        self._runs = directory / "runs.csv"
        if self._runs.exists():
            raise ParameterError(f"{self._runs} already exists; name another directory with --out")

    def tune(self, tuning: Tuning, observe: Observer) -> tuple[Candidate, ...]:
        """Tune the candidates that have not been tuned before an interruption."""
        journal = Journal(self.directory / "tuning.json", tuning, TunedCandidate._fields)
        try:
            results = journal.record(tuning.tune(journal))
            observe(results, len(tuning.candidates), len(journal))
            tuned = [journal[number] for number in range(len(tuning.candidates))]
        finally:
            journal.close()
        self._write("tuning.json", tuned)
        return tuple(
            each._replace(settings=found["settings"], ranges={})
            for each, found in zip(tuning.candidates, tuned, strict=True)
        )

    def run(
        self, comparison: Comparison, runner: Runner, observe: Observer
    ) -> list[dict[str, Any]]:
        """Run what is missing; returns a row per run, and writes runs and rigs."""
        journal = Journal(self._runs, comparison)
        runs = list(comparison.runs())
        try:
            results = journal.record(runner(comparison, journal))
            observe(results, len(runs), len(journal))
            rows = [run._asdict() | journal[number] for number, run in enumerate(runs)]
        finally:
            journal.close()
        rigs = list(comparison.rigs.generate(comparison.settings))
        write_csv(rig_rows(rigs), self.directory / "rigs.csv")
        write_csv(rows, self._runs)
        self._delete_journals()
        return rows

    def write_summary(self, summary: dict[str, Any]) -> None:
        """Write the scores."""
        self._write("summary.json", summary)

    def _write(self, name: str, content: Any) -> None:
        (self.directory / name).write_text(json.dumps(content, indent=1) + "\n")

    def _delete_journals(self) -> None:
        for journal in self.directory.glob("*.part"):
            journal.unlink()
