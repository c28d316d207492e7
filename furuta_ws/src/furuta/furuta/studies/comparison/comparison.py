"""A comparison: every candidate on every simulated rig, undisturbed and with every push."""

from array import array
from collections import deque
from collections.abc import Iterable, Iterator
from itertools import zip_longest
from typing import Any, NamedTuple

import numpy as np

from furuta.lanes.batch import batch
from furuta.outcomes import outcome, residual, sensors_alone
from furuta.settings.settings import Settings, loop
from furuta.studies.comparison.candidates import UNCOMPENSATED, Candidate
from furuta.studies.comparison.rigs import RandomRigs, SimulatedRig
from furuta_model.late_drive import MAX_DELAY
from furuta_model.parameters import ParameterError, validated
from furuta_model.parts.disturbances import Pushes
from furuta_sim.parameters import PlantParameters
from furuta_sim.simulation.closed_loop import Loop

# Duration of a push on the arm [s].
PUSH_DURATION = 0.1
# Numbers that are kept of a run.
MEASURED = 4
# Time [s] in which a pendulum falls if the delay is too long.
DELAYED_SECONDS = 10.0


class Table(NamedTuple):
    """Residuals [rad] and commands [V] (candidates, rigs), and which pushes were survived.

    The residual of a rig is the arm angle, peak to peak, and infinite after a fall. ``command`` is
    the rms value, ``step`` and ``fast`` those of its chatter. ``uncompensated`` (rigs,) is the
    residual without compensation. On the nominal rig ``delay`` [s] is the delay margin of each
    candidate, and ``sensors`` [rad] the residual that the sensors alone cause.
    """

    candidates: list[str]
    rigs: list[str]
    residual: np.ndarray
    command: np.ndarray
    step: np.ndarray
    fast: np.ndarray
    survived: np.ndarray
    uncompensated: np.ndarray
    delay: list[float]
    sensors: list[float]


class Comparison:
    """Candidates on rigs that they do not know, in runs of ``seconds`` [s].

    Each of ``pushes`` [V] but 0 acts on the arm in the middle of a run of its own. ``impossible``
    are the reasons why some of the rigs are left out, by their names.
    """

    def __init__(
        self,
        settings: Settings,
        rigs: list[SimulatedRig] | RandomRigs,
        candidates: tuple[Candidate, ...],
        seconds: float,
        pushes: Iterable[float] = (),
    ) -> None:
        if not candidates:
            raise ParameterError("a comparison needs at least one candidate, given none")
        self.impossible: dict[str, str] = {}
        self._settings = settings
        self._rigs = rigs
        self._names = [candidate.name for candidate in candidates]
        controls = [loop(each.applied_to(settings)) for each in (*candidates, UNCOMPENSATED)]
        # It runs on its own unless a candidate is the same.
        self._uncompensated = controls.index(controls[-1])
        self._controls = controls[: max(self._uncompensated + 1, len(candidates))]
        self._seconds = seconds
        self._pushes = [push for push in dict.fromkeys(pushes) if push]
        self._simulated: list[str] = []
        self._measured = array("d")

    @property
    def size(self) -> int:
        """The number of runs."""
        return len(self._rigs) * len(self._names) * (1 + len(self._pushes))

    def rows(self) -> Iterator[dict[str, Any]]:
        """Run everything; yields a row per run: rig, candidate, push and outcome."""
        waiting: deque[dict[str, Any]] = deque()
        for run in batch(self._loops(waiting), self._seconds):
            self._measured.extend(
                (
                    residual(run),
                    run.command_rms_v,
                    run.command_step_v,
                    run.command_high_frequency_v,
                )
            )
            if row := waiting.popleft():
                yield row | vars(run)
        if not self._simulated:
            raise ParameterError(f"no rig is possible: {next(iter(self.impossible.values()))}")

    def table(self) -> Table:
        """What the rows say, once all of them have been taken."""
        shape = len(self._simulated), len(self._controls), 1 + len(self._pushes), MEASURED
        measured = np.reshape(self._measured, shape).transpose(3, 1, 0, 2)
        sizes, *commands = measured[:, : len(self._names)]
        rms, step, fast = (each[:, :, 0] for each in commands)
        survived = np.isfinite(sizes[:, :, 1:])
        uncompensated = measured[0, self._uncompensated, :, 0]
        controls = self._controls[: len(self._names)]
        return Table(
            *(self._names, self._simulated, sizes[:, :, 0], rms, step, fast, survived),
            *(uncompensated, list(map(delay_margin, controls)), list(map(sensors_alone, controls))),
        )

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
            for candidate, control in zip_longest(self._names, self._controls):
                for push, plant in plants:
                    run = {"rig": rig.name, "candidate": candidate, "push_v": push}
                    waiting.append({} if candidate is None else run | numbers)
                    yield control._replace(plant=plant)

    def _pushed(self, plant: PlantParameters) -> Iterator[tuple[float, PlantParameters]]:
        """The push [V], 0 for none, and the plant of every run."""
        yield 0.0, plant
        middle = (self._seconds / 2,)
        for push in self._pushes:
            pushed = validated(Pushes(middle, (PUSH_DURATION,), (push,)))
            yield push, plant._replace(pushes=pushed)


def delay_margin(control: Loop) -> float:
    """The longest delay of the drive [s] with which the pendulum does not fall.

    It is found by bisection in whole samples, and is at most :data:`MAX_DELAY` of them.
    """
    plant, stands, falls = control.plant, -1, MAX_DELAY + 1
    while falls - stands > 1:
        delay = (stands + falls) // 2
        late = plant.drive.late._replace(delay=delay)
        delayed = plant._replace(drive=plant.drive._replace(late=late))
        if outcome(control._replace(plant=delayed), DELAYED_SECONDS).fell:
            falls = delay
        else:
            stands = delay
    return max(stands, 0) * plant.sample_time
