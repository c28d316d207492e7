"""Studies of many loops: sweeps, comparisons on rigs that are not known, swing-ups."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from furuta.arguments import check
from furuta.loops import checked_loop, loop_from, make_loop, plain_value
from furuta.motions import check_seconds
from furuta.results.table import Table
from furuta_model.parameters import ParameterError
from furuta_model.progress import Progress, unseen
from furuta_sim.simulation.closed_loop import Loop

if TYPE_CHECKING:
    from furuta.results.studies import Comparison, Runs, SwingUp
    from furuta.studies.comparison.rigs import RandomRigs, SimulatedRig
    from furuta.studies.sweep import SweptParameter

# Values of a range that does not say how many.
COUNT = 10
# Rigs that have names.
NAMED = "named"
_PLANT = "plant."


def sweep(
    values: Mapping[str, Iterable[Any]] | Iterable[str],
    loop: Loop | None = None,
    seconds: float = 60.0,
    *,
    out: str | Path | None = None,
    keep_runs: bool = True,
    scheduler: str | None = None,
    progress: Progress = unseen,
) -> Runs:
    """Measure loops with every combination of values, on all cores.

    Args:
        values: Values of each parameter, by the names that :func:`furuta.make_loop` takes. The last
            parameter changes fastest. Or texts NAME=LOW:HIGH[:COUNT] or NAME=VALUE,VALUE.
        loop: The loop to which they are applied; by default that of the paper.
        seconds: Simulated time of each run [s]; its second half is measured.
        out: A new file (.csv, .parquet), to which the rows are written as they come.
        keep_runs: Whether the result has the rows. Without them memory does not grow.
        scheduler: Address of a Dask scheduler, on whose cluster it runs instead.
        progress: Gets the rows and their number, and yields them.

    Returns:
        A row per run: its parameters, what :func:`furuta.measure` returns, and ``error``, which
        says why its parameters are impossible. Such a run has NaN.

    Raises:
        ParameterError: A name is unknown, there are too many runs, none is possible, or the file
            exists.
    """
    from furuta.lanes.batch import batch
    from furuta.results.studies import Runs
    from furuta.settings.settings import loop_settings
    from furuta.studies.study_tables import Passed
    from furuta.studies.sweep import Sweep, outcomes_on_cluster, run

    check_seconds(seconds)
    axes = tuple(_swept(values))
    study = Sweep(loop_settings(checked_loop(loop)), axes, seconds)
    size = study.size()
    simulate = partial(outcomes_on_cluster, scheduler) if scheduler else batch
    passed = Passed(axis.name for axis in axes)
    pairs = zip(study.points(), run(study, simulate), strict=True)
    rows = passed.passing(progress((point | result for point, result in pairs), size))
    kept = _taken(rows, out, keep_runs)
    if passed.impossible == passed.runs:
        raise ParameterError(f"no run is possible: {passed.reason}")
    return Runs(passed, kept, None if out is None else Path(out))


def _swept(values: Any) -> Iterator[SweptParameter]:
    """The parameters and their values, which must exist."""
    from furuta.settings.parameter_names import parameters_named
    from furuta.studies.sweep import SweptParameter, parse_swept_parameter

    if not isinstance(values, Mapping):
        yield from (parse_swept_parameter(text, COUNT) for text in values)
        return
    for name, given in values.items():
        parameters_named(name)
        each = check(f"the values of {name}", given, Iterable)
        if not each:
            raise ParameterError(f"the values of {name} must be at least one, given none")
        yield SweptParameter(name, tuple(map(plain_value, each)))


def _taken(
    rows: Iterable[Mapping[str, Any]], out: str | Path | None, keep: bool
) -> Iterable[Mapping[str, Any]]:
    """The rows to keep, if any, after all have been written to a new file as they came."""
    from furuta.studies.study_tables import check_table, write_runs

    kept: deque[Mapping[str, Any]] = deque(maxlen=None if keep else 0)

    def passing() -> Iterator[Mapping[str, Any]]:
        for row in rows:
            kept.append(row)
            yield row

    if out is None:
        deque(passing(), maxlen=0)
    else:
        check_table(Path(out))
        write_runs(passing(), Path(out))
    return kept


def random_rigs(
    number: int = 100,
    loop: Loop | None = None,
    *,
    rig: str | Path | None = None,
    seed: int = 0,
    disturbances: Iterable[str] = (),
) -> Table:
    """Plants of random rigs, those by which :func:`furuta.compare` judges.

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
    from furuta.studies.study_tables import columns

    nominal = make_loop(rig=rig) if loop is None else checked_loop(loop)
    rigs = _random(number, nominal, rig, seed, disturbances)
    named = ({_PLANT + name: each for name, each in of.values.items()} for of in rigs)
    return Table(columns(named))


def _random(
    number: int, loop: Loop, rig: str | Path | None, seed: int, disturbances: Iterable[str]
) -> RandomRigs:
    from furuta.settings.settings import loop_settings
    from furuta.studies.comparison.rigs import NOMINAL, RandomRigs
    from furuta_hw.rigs.known_rigs import rig_file
    from furuta_hw.rigs.rig_file import load_uncertain_rig
    from furuta_hw.rigs.uncertainty import CERTAIN

    about = (NOMINAL, CERTAIN) if rig is None else load_uncertain_rig(rig_file(str(rig)))
    return RandomRigs(loop_settings(loop), number, seed, tuple(disturbances), *about)


def compare(
    loop: Loop | None = None,
    candidates: Iterable[str] | Mapping[str, Mapping[str, Any]] | None = None,
    rigs: int | str | Mapping[str, Any] = 100,
    *,
    rig: str | Path | None = None,
    seed: int = 0,
    disturbances: Iterable[str] = (),
    seconds: float = 30.0,
    pushes: Iterable[float] = (),
    bandwidths: bool = False,
    out: str | Path | None = None,
    keep_runs: bool = False,
    progress: Progress = unseen,
) -> Comparison:
    """Compare compensations on simulated rigs that they do not know.

    Args:
        loop: The nominal loop; by default that of the rig.
        candidates: Names of standard candidates, or texts NAME=PARAMETER=VALUE,...; or the values
            of each one by its name, as :func:`furuta.make_loop` takes them. By default all standard
            ones.
        rigs: The first so many random rigs; "named" for the built-in ones; or a table of plants,
            such as :func:`random_rigs` returns.
        rig: Of random rigs, as of :func:`random_rigs`.
        seed: As there.
        disturbances: As there.
        seconds: Simulated time of each run [s]; its second half is measured.
        pushes: Pushes on the arm [V] of 0.1 s, each in a run of its own.
        bandwidths: Find the recommended compensation's best bandwidth on each rig.
        out: A new file (.csv, .parquet), to which a row per run is written as they come.
        keep_runs: Whether the result has a row per run as its ``runs``: rig, candidate, push,
            parameters of the plant, and what :func:`furuta.measure` returns.
        progress: Gets the runs and their number, and yields them.

    Returns:
        A row per candidate, from the best to the worst.

    Raises:
        ParameterError: A candidate or a rig is not possible, a number is out of its range, an
            argument does not belong to these rigs, or the file exists.
    """
    from furuta.results.studies import Comparison
    from furuta.settings.settings import loop_settings
    from furuta.studies.comparison import comparison
    from furuta.studies.comparison.candidates import bandwidth_candidates
    from furuta.studies.comparison.rigs import named_rigs
    from furuta.studies.comparison.scores import best_bandwidths
    from furuta.studies.study_tables import columns

    check_seconds(seconds)
    loop = make_loop(rig=rig) if loop is None else checked_loop(loop)
    settings = loop_settings(loop)
    simulated: list[SimulatedRig] | RandomRigs
    disturbances = list(disturbances)
    if isinstance(rigs, int):
        simulated = _random(rigs, loop, rig, seed, disturbances)
    elif rig is not None or seed or disturbances:
        raise ParameterError("rig, seed and disturbances are of random rigs: give their number")
    elif isinstance(rigs, str):
        if rigs != NAMED:
            raise ParameterError(f"rigs must be a number, {NAMED!r} or a table, given {rigs!r}")
        simulated = named_rigs(settings)
    else:
        simulated = _rigs_of(rigs)
    chosen = _candidates(candidates, settings)
    study = comparison.Comparison(settings, simulated, chosen, seconds, pushes)
    kept = _taken(progress(study.rows(), study.size), out, keep_runs)
    count = loop.plant.sensors.encoder_count
    found = Comparison(study.table(), count, chosen, study.impossible)
    found.by_rig, found.runs = rigs == NAMED, Table(columns(kept))
    if bandwidths:
        scaled = comparison.Comparison(settings, simulated, bandwidth_candidates(), seconds)
        deque(progress(scaled.rows(), scaled.size), maxlen=0)
        found.best_bandwidths = best_bandwidths(scaled.table())
    return found


def _candidates(given: Any, settings: Any) -> tuple[Any, ...]:
    """The candidates; their values are without numpy."""
    from furuta.studies.comparison.candidates import STANDARD, candidate_of, parse_candidates

    if not isinstance(given, Mapping):
        return parse_candidates(STANDARD if given is None else given, settings)
    named = {name: check(f"candidate {name}", of, Mapping[str, Any]) for name, of in given.items()}
    return tuple(
        candidate_of(name, {key: plain_value(each) for key, each in of.items()}, settings)
        for name, of in named.items()
    )


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


def swing_up(
    starts: int = 100,
    values: Mapping[str, Any] | Iterable[str] | None = None,
    *,
    rig: str | Path = "paper_full_turn",
    files: Iterable[str | Path] = (),
    seed: int = 0,
    knocks: bool = False,
    progress: Progress = unseen,
) -> SwingUp:
    """Swing up from random states, on plants up to 10 % off the model.

    Args:
        starts: Number of random starts, of 12 s each.
        values: As of :func:`furuta.make_loop`; they take precedence over a setting for swing-up.
        rig: A rig that measures the whole turn, its name or its file.
        files: As of :func:`furuta.make_loop`.
        seed: Which random starts.
        knocks: Also push the pendulum over every 10 s, in a run of 60 s on the model itself.
        progress: Gets the starts and their number, and yields them.

    Returns:
        How many are upright within 10 s and stay so, how many exceed a limit of the controller, and
        the median and worst time.

    Raises:
        ParameterError: A value is not allowed, or the rig cannot swing up.
    """
    from furuta.results.studies import SwingUp
    from furuta.studies import swing_up as study
    from furuta_hw.rigs.known_rigs import find_rig

    if starts < 1 or seed < 0:
        raise ParameterError(f"starts must be at least 1 and seed 0, given {starts} and {seed}")
    nominal = loop_from(study.swing_up_settings(find_rig(str(rig))), values, files)
    runs = study.run_starts(study.random_starts(nominal, starts, seed))
    pushed = study.run_knocks(nominal) if knocks else None
    done = list(progress(runs, starts))
    return SwingUp(**vars(study.starts_summary(done)), runs=done, knocks=pushed)
