"""A comparison: every candidate on every simulated rig, with every noise seed and every push.

Runs are independent and numbered, so they can be computed in any order, on a cluster, and after an
interruption.
"""

from __future__ import annotations

from collections.abc import Container, Iterator
from typing import Any, NamedTuple

from furuta.studies.comparison.candidates import Candidate
from furuta.studies.comparison.random_rigs import JUDGING, random_rig
from furuta.studies.comparison.simulated_rigs import SimulatedRig, named_rigs, nominal_values
from furuta_model.parameters import ParameterError
from furuta_sim.parameters import PlantParameters
from furuta_sim.settings.settings import Settings, loop
from furuta_sim.simulation.closed_loop import Loop

ROWS = ("named", "random")


class Rigs(NamedTuple):
    """Which rigs: the named ones, or ``size`` random ones of a ``seed`` from number ``first``."""

    rows: str = "named"
    size: int = 100
    first: int = 0
    seed: int = 0
    disturbances: tuple[str, ...] = ()
    purpose: int = JUDGING

    def generate(self, settings: Settings) -> Iterator[SimulatedRig]:
        """Generate the rigs in order."""
        if self.rows == "named":
            yield from named_rigs(settings)
            return
        nominal = nominal_values(settings)
        for number in range(self.first, self.first + self.size):
            yield random_rig(nominal, number, self.seed, self.disturbances, self.purpose)


class Run(NamedTuple):
    """Rig, candidate, seed of the noise, and push on the arm [V] (0 for none) of a run."""

    rig: str
    candidate: str
    seed: int
    push_v: float


class Comparison(NamedTuple):
    """Base settings, rigs, candidates, number of seeds, pushes [V] and seconds per run.

    A push acts in the middle of a run of its own with the first seed.
    """

    settings: Settings
    rigs: Rigs
    candidates: tuple[Candidate, ...]
    seeds: int
    pushes: tuple[float, ...]
    seconds: float

    def runs(self) -> Iterator[Run]:
        """All runs in order."""
        for rig in self.rigs.generate(self.settings):
            yield from self._runs_on(rig)

    def remaining_loops(self, done: Container[int]) -> Iterator[tuple[int, Loop | str]]:
        """The loop of every run that is not ``done``, or the reason why it is impossible."""
        control = {each.name: loop(each.applied_to(self.settings)) for each in self.candidates}
        number = 0
        for rig in self.rigs.generate(self.settings):
            plants: dict[tuple[int, float], PlantParameters | str] = {}
            for run in self._runs_on(rig):
                case = run.seed, run.push_v
                if number not in done:
                    if case not in plants:
                        plants[case] = self._plant(rig, *case)
                    yield number, _with_plant(control[run.candidate], plants[case])
                number += 1

    def _runs_on(self, rig: SimulatedRig) -> Iterator[Run]:
        seed = self.settings["plant"].get("seed", 0)
        for candidate in self.candidates:
            for k in range(self.seeds):
                yield Run(rig.name, candidate.name, seed + k, 0.0)
            for push in self.pushes:
                yield Run(rig.name, candidate.name, seed, push)

    def _plant(self, rig: SimulatedRig, seed: int, push: float) -> PlantParameters | str:
        try:
            return rig.plant(self.settings, seed, push, self.seconds / 2)
        except ParameterError as error:
            return f"rig {rig.name}: {error}"


def _with_plant(control: Loop, plant: PlantParameters | str) -> Loop | str:
    return plant if isinstance(plant, str) else control._replace(plant=plant)


def rig_rows(rigs: list[SimulatedRig]) -> list[dict[str, Any]]:
    """A table of the rigs; a parameter that a rig leaves as it is set is empty."""
    names = dict.fromkeys(name for rig in rigs for name in rig.values)
    return [{"rig": rig.name} | {name: rig.values.get(name, "") for name in names} for rig in rigs]
