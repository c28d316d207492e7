"""Studies of many loops as tables: columns (n,) by name, which pandas takes in one call."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from furuta.arguments import check
from furuta.loops import checked_loop, make_loop, plain_value
from furuta.motions import check_seconds
from furuta_model.parameters import ParameterError
from furuta_sim.simulation.closed_loop import Loop

if TYPE_CHECKING:
    from furuta.studies.comparison.rigs import SimulatedRig

Table = dict[str, np.ndarray]
_PLANT = "plant."


def sweep(
    values: Mapping[str, Iterable[Any]], loop: Loop | None = None, seconds: float = 60.0
) -> Table:
    """Measure loops with every combination of values, on all cores.

    Args:
        values: Values of each parameter, by the names that :func:`furuta.make_loop` takes. The last
            parameter changes fastest.
        loop: The loop to which they are applied; by default that of the paper.
        seconds: Simulated time of each run [s]; its second half is measured.

    Returns:
        A row per run: its parameters, what :func:`furuta.measure` returns, and ``error``, which
        says why its parameters are impossible. Such a run has NaN.

    Raises:
        ParameterError: A name is unknown, there are too many runs, or none is possible.
    """
    from furuta.settings.settings import loop_settings
    from furuta.studies.study_tables import columns
    from furuta.studies.sweep import Sweep, SweptParameter, run

    check_seconds(seconds)
    axes = tuple(SweptParameter(name, _values(name, each)) for name, each in values.items())
    study = Sweep(loop_settings(checked_loop(loop)), axes, seconds)
    study.size()
    rows = [point | result for point, result in zip(study.points(), run(study), strict=True)]
    if all(row["error"] for row in rows):
        raise ParameterError(f"no run is possible: {rows[0]['error']}")
    return columns(rows)


def _values(name: str, given: Any) -> tuple[Any, ...]:
    """The values of a parameter, which must exist."""
    from furuta.settings.parameter_names import parameters_named

    parameters_named(name)
    values = check(f"the values of {name}", given, Iterable)
    if not values:
        raise ParameterError(f"the values of {name} must be at least one, given none")
    return tuple(map(plain_value, values))


def random_rigs(
    number: int = 100,
    loop: Loop | None = None,
    *,
    rig: str | Path | None = None,
    seed: int = 0,
    disturbances: Iterable[str] = (),
) -> Table:
    """Plants of random rigs, those by which ``furuta compare`` judges.

    Args:
        number: Number of rigs. Rig k of a seed is the same for any number.
        loop: Its plant is the nominal one; by default that of the rig.
        rig: A rig's name or file, which may say how uncertain its values are. Otherwise friction
            law, friction and pendulum are random.
        seed: Which random rigs.
        disturbances: Others beside: delay, lag, noise, turn, asymmetry, cogging, coupling, or all.

    Returns:
        A row per rig: parameters of its plant, as :func:`furuta.make_loop` takes them.

    Raises:
        ParameterError: There is no such rig or disturbance, or a number is out of its range.
    """
    from furuta.settings.settings import loop_settings
    from furuta.studies.comparison.rigs import NOMINAL, RandomRigs
    from furuta.studies.study_tables import columns
    from furuta_hw.rigs.known_rigs import rig_file
    from furuta_hw.rigs.rig_file import load_uncertain_rig
    from furuta_hw.rigs.uncertainty import CERTAIN

    about = (NOMINAL, CERTAIN) if rig is None else load_uncertain_rig(rig_file(str(rig)))
    settings = loop_settings(make_loop(rig=rig) if loop is None else checked_loop(loop))
    rigs = RandomRigs(settings, number, seed, tuple(disturbances), *about)
    return columns({_PLANT + name: each for name, each in rig.values.items()} for rig in rigs)


def compare(
    loop: Loop | None = None,
    candidates: Iterable[str] | Mapping[str, Mapping[str, Any]] | None = None,
    rigs: int | Mapping[str, Any] = 100,
    *,
    seconds: float = 30.0,
    pushes: Iterable[float] = (),
    by_run: bool = False,
) -> Table:
    """Compare compensations on simulated rigs that they do not know, as ``furuta compare`` does.

    Args:
        loop: The nominal loop; by default that of the paper.
        candidates: Names of standard candidates; or the values of each one by its name, as
            :func:`furuta.make_loop` takes them. By default all standard ones.
        rigs: The first so many random rigs; or a table of plants, such as :func:`random_rigs`
            returns.
        seconds: Simulated time of each run [s]; its second half is measured.
        pushes: Pushes on the arm [V] of 0.1 s, each in a run of its own.
        by_run: Return a row per run instead.

    Returns:
        A row per candidate, from the best to the worst: residuals, on how many rigs they are worse
        than without compensation, what the sensors alone cause, falls, commands, delay margin, and
        which one is ``recommended``. Or a row per run: rig, candidate, push, parameters of the
        plant, and what :func:`furuta.measure` returns.

    Raises:
        ParameterError: A candidate or a rig is not possible, or a number is out of its range.
    """
    from furuta.settings.settings import loop_settings
    from furuta.studies.comparison.candidates import STANDARD, candidate_of, parse_candidates
    from furuta.studies.comparison.comparison import Comparison
    from furuta.studies.comparison.rigs import RandomRigs
    from furuta.studies.comparison.scores import rank, recommended
    from furuta.studies.study_tables import columns

    check_seconds(seconds)
    loop = checked_loop(loop)
    settings = loop_settings(loop)
    if isinstance(candidates, Mapping):
        pairs = ((name, _plain(name, values)) for name, values in candidates.items())
        chosen = tuple(candidate_of(*pair, settings) for pair in pairs)
    else:
        chosen = parse_candidates(STANDARD if candidates is None else candidates, settings)
    simulated = RandomRigs(settings, rigs) if isinstance(rigs, int) else _rigs_of(rigs)
    comparison = Comparison(settings, simulated, chosen, seconds, pushes)
    rows = list(comparison.rows())
    if by_run:
        return columns(rows)
    scores = rank(comparison.table(), loop.plant.sensors.encoder_count)
    best = recommended(scores, loop.plant.sensors.encoder_count)
    return columns({**score._asdict(), "recommended": score is best} for score in scores)


def _plain(name: str, values: Any) -> dict[str, Any]:
    """The values of a candidate by name, without numpy."""
    given = check(f"candidate {name}", values, Mapping[str, Any])
    return {key: plain_value(value) for key, value in given.items()}


def _rigs_of(table: Mapping[str, Any]) -> list[SimulatedRig]:
    """The rigs of a table, one per row."""
    from furuta.settings.parameter_names import parameters_in
    from furuta.studies.comparison.rigs import SimulatedRig

    names = [name.removeprefix(_PLANT) for name in table]
    for name in names:
        parameters_in("plant", name)
    columns = [check(f"column {name}", column, Iterable) for name, column in table.items()]
    if len({len(column) for column in columns}) != 1 or not columns[0]:
        raise ParameterError("a table of rigs must have columns of one and the same length, not 0")
    rows = zip(*columns, strict=True)
    return [
        SimulatedRig(str(k), dict(zip(names, map(plain_value, row), strict=True)))
        for k, row in enumerate(rows)
    ]
