"""A comparison: every candidate on every simulated rig, undisturbed and with every push."""

from array import array
from collections import deque
from collections.abc import Iterator
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np

from furuta.studies.comparison.candidates import Candidate
from furuta.studies.comparison.rigs import RandomRigs, SimulatedRig
from furuta_model.parameters import ParameterError
from furuta_model.parts.pushes import Pushes
from furuta_sim.lanes.batch import batch
from furuta_sim.parameters import PlantParameters
from furuta_sim.settings.settings import Settings, loop
from furuta_sim.simulation.closed_loop import Loop, Outcome

# Duration of a push on the arm [s].
PUSH_DURATION = 0.1


class Table(NamedTuple):
    """Residuals [rad] and rms commands [V] (candidates, rigs), and which pushes were survived.

    The residual of a rig is the arm angle, peak to peak, and infinite after a fall.
    """

    candidates: list[str]
    rigs: list[str]
    residual: np.ndarray
    command: np.ndarray
    survived: np.ndarray


class Comparison:
    """Candidates on rigs that they do not know, in runs of ``seconds`` [s].

    Each of ``pushes`` [V] acts on the arm in the middle of a run of its own. ``impossible`` are the
    reasons why some of the rigs are left out, by their names.
    """

    def __init__(
        self,
        settings: Settings,
        rigs: list[SimulatedRig] | RandomRigs,
        candidates: tuple[Candidate, ...],
        seconds: float,
        pushes: tuple[float, ...] = (),
    ) -> None:
        self.impossible: dict[str, str] = {}
        self._settings = settings
        self._rigs = rigs
        self._controls = {
            candidate.name: loop(candidate.applied_to(settings)) for candidate in candidates
        }
        self._seconds = seconds
        self._pushes = pushes
        self._simulated: list[str] = []
        self._sizes = array("d")
        self._commands = array("d")

    @property
    def size(self) -> int:
        """The number of runs."""
        return len(self._rigs) * len(self._controls) * (1 + len(self._pushes))

    def rows(self) -> Iterator[dict[str, Any]]:
        """Run everything; yields a row per run: rig, candidate, push and outcome."""
        waiting: deque[dict[str, Any]] = deque()
        for outcome in batch(self._loops(waiting), self._seconds):
            self._sizes.append(residual(outcome))
            self._commands.append(outcome.command_rms_v)
            yield waiting.popleft() | outcome._asdict()
        if not self._simulated:
            raise ParameterError(f"no rig is possible: {next(iter(self.impossible.values()))}")

    def table(self) -> Table:
        """What the rows say, once all of them have been taken."""
        shape = len(self._simulated), len(self._controls), 1 + len(self._pushes)
        sizes = np.reshape(self._sizes, shape).transpose(1, 0, 2)
        commands = np.reshape(self._commands, shape).transpose(1, 0, 2)
        survived = np.isfinite(sizes[:, :, 1:])
        names = list(self._controls)
        return Table(names, self._simulated, sizes[:, :, 0], commands[:, :, 0], survived)

    def _loops(self, waiting: deque[dict[str, Any]]) -> Iterator[Loop]:
        """The loop of every run; the beginning of its row is appended to ``waiting``."""
        for rig in self._rigs:
            try:
                plants = list(self._pushed(rig.plant(self._settings)))
            except ParameterError as error:
                self.impossible[rig.name] = str(error)
                continue
            self._simulated.append(rig.name)
            numbers = {k: value for k, value in rig.values.items() if not isinstance(value, list)}
            for candidate, control in self._controls.items():
                for push, plant in plants:
                    run = {"rig": rig.name, "candidate": candidate, "push_v": push}
                    waiting.append(run | numbers)
                    yield control._replace(plant=plant)

    def _pushed(self, plant: PlantParameters) -> Iterator[tuple[float, PlantParameters]]:
        """The push [V], 0 for none, and the plant of every run."""
        yield 0.0, plant
        middle = (self._seconds / 2,)
        for push in self._pushes:
            yield push, plant._replace(pushes=Pushes(middle, (PUSH_DURATION,), (push,)))


def residual(outcome: Outcome) -> float:
    """The arm's angle, peak to peak [rad], in the settled part; infinite after a fall."""
    return inf if outcome.fell else outcome.phi_peak_to_peak_rad


def encoder_resolution(loop: Loop) -> float:
    """One count of the arm's encoder [rad], 0 without quantisation."""
    counts = loop.plant.sensors.encoder_counts
    return 2 * pi / counts if counts else 0.0
