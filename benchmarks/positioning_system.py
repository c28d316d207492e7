"""Friction of the positioning system EMPS: fits, comparison of laws, prediction of a test record.

    tools/in_environment python benchmarks/positioning_system.py fit train.csv --out emps.json
    tools/in_environment python benchmarks/positioning_system.py compare train.csv
    tools/in_environment python benchmarks/positioning_system.py predict emps.json test.csv

A record is a CSV table: time [s], position [m], reference [m], motor voltage signal [V]. The error
is that of the free run: the model gets the voltage of the whole record, and the position only at
the start. Sticking makes that error a rough function of the parameters. A global search
(differential evolution) finds the minimum, and the simplex method refines it.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from time import perf_counter

import numpy as np
from positioning_model import Joint, Record, error_mm, predict, read_record
from scipy.optimize import differential_evolution, minimize

# Range of each parameter in the search.
RANGES = {
    "mass": (85.0, 105.0),
    "viscous": (150.0, 260.0),
    "coulomb": (15.0, 26.0),
    "direction": (-80.0, 80.0),
    "drift": (-0.1, 0.1),
    "delay": (0.0, 3e-3),
    "offset": (-5.0, 5.0),
    "stiction": (-4.0, 8.0),
    "stribeck_velocity": (5e-3, 0.08),
    "asymmetry": (-0.1, 0.1),
    "load": (-0.05, 0.05),
    "stiffness": (1e4, 1e6),
}
BODY = ("mass", "viscous", "coulomb")
# The chosen law, and the others: the parameters that are fitted.
CHOSEN = (*BODY, "direction", "drift")
LAWS: dict[str, tuple[str, ...]] = {
    "Coulomb, viscous, offset (published form)": (*BODY, "offset"),
    "viscous friction by direction": (*BODY, "direction"),
    "Coulomb friction by direction, drift": (*BODY, "asymmetry", "offset", "drift"),
    "published form, drift": (*BODY, "offset", "drift"),
    "viscous by direction, drift (chosen)": CHOSEN,
    "the same, delay": (*BODY, "direction", "drift", "delay"),
    "the same, offset": (*BODY, "direction", "drift", "offset"),
    "the same, Stribeck": (*BODY, "direction", "drift", "stiction", "stribeck_velocity"),
    "the same, load": (*BODY, "direction", "drift", "load"),
    "the same, LuGre": (*BODY, "direction", "drift", "stiffness"),
}
# Size of the search, and of the blocks of time from whose scatter the errors are found [s].
GENERATIONS, POPULATION, SIMPLEX = 50, 8, 600
BLOCK = 1.0


def fit(record: Record, names: tuple[str, ...], seed: int = 1) -> Joint:
    """The joint with the smallest error of the free run."""

    def error(vector: np.ndarray) -> float:
        return error_mm(_joint(names, vector), record)

    ranges = [RANGES[name] for name in names]
    found = differential_evolution(
        error, ranges, maxiter=GENERATIONS, popsize=POPULATION, seed=seed, tol=1e-6, polish=False
    )
    options = {"maxfev": SIMPLEX, "xatol": 1e-4, "fatol": 1e-4}
    best = minimize(error, found.x, method="Nelder-Mead", bounds=ranges, options=options)
    return _joint(names, best.x)


def standard_errors(joint: Joint, record: Record, names: tuple[str, ...]) -> dict[str, float]:
    """From the scatter of the slopes between blocks of time (sandwich estimate)."""
    residuals = record.position - predict(joint, record)
    columns = []
    for name in names:
        low, high = RANGES[name]
        step = 2e-3 * (high - low)
        ahead, behind = (
            predict(joint._replace(**{name: getattr(joint, name) + each}), record)
            for each in (step, -step)
        )
        columns.append((ahead - behind) / (2.0 * step))
    slopes = np.column_stack(columns)
    inverse = np.linalg.pinv(slopes.T @ slopes)
    size = max(1, round(BLOCK / record.step))
    blocks = [slice(begin, begin + size) for begin in range(0, len(residuals), size)]
    scores = np.array([slopes[each].T @ residuals[each] for each in blocks])
    errors = np.sqrt(np.diag(inverse @ scores.T @ scores @ inverse))
    return dict(zip(names, (float(each) for each in errors), strict=True))


def _joint(names: tuple[str, ...], vector: np.ndarray) -> Joint:
    return Joint()._replace(**dict(zip(names, (float(each) for each in vector), strict=True)))


def _fit(file: Path, out: Path) -> None:
    record = read_record(file)
    begin = perf_counter()
    joint = fit(record, CHOSEN)
    seconds = perf_counter() - begin
    errors = standard_errors(joint, record, CHOSEN)
    for name in CHOSEN:
        print(f"{name:20} {getattr(joint, name):12.6g} ± {errors[name]:.2g}")
    print(f"error of the free run {error_mm(joint, record):.3f} mm; fitted in {seconds:.0f} s")
    out.write_text(json.dumps({"joint": joint._asdict(), "standard_errors": errors}, indent=1))


def _compare(file: Path) -> None:
    record = read_record(file)
    middle = len(record.time) // 2
    first, second = record.part(0, middle), record.part(middle, len(record.time))
    print(f"{'law':44}{'parameters':>11}{'1st half':>10}{'2nd half':>10}{'whole':>8}   [mm]")
    for name, free in LAWS.items():
        joint, whole = fit(first, free), fit(record, free)
        held_out = _held_out(joint, second, record)
        sizes = f"{error_mm(joint, first):10.2f}{held_out:10.2f}{error_mm(whole, record):8.2f}"
        print(f"{name:44}{len(free):11d}{sizes}", flush=True)


def _held_out(joint: Joint, second: Record, record: Record) -> float:
    """Error [mm] of the free run over the second half; the drift counts from the record's start."""
    passed = float(second.time[0] - record.time[0])
    return error_mm(joint._replace(offset=joint.offset + joint.drift * passed), second)


def _predict(model: Path, file: Path, out: Path | None) -> None:
    joint, record = Joint(**json.loads(model.read_text())["joint"]), read_record(file)
    print(f"error of the free run {error_mm(joint, record):.3f} mm over {len(record.time)} samples")
    if out is not None:
        table = np.column_stack((record.time, record.position, predict(joint, record)))
        np.savetxt(out, table, delimiter=",", header="time_s,position_m,predicted_m", comments="")


def main() -> None:
    """Fit, compare or predict."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])  # type: ignore[union-attr]
    verbs = parser.add_subparsers(dest="verb", required=True)
    for verb in ("fit", "compare", "predict"):
        each = verbs.add_parser(verb)
        if verb == "predict":
            each.add_argument("model", type=Path)
        each.add_argument("record", type=Path)
        if verb != "compare":
            each.add_argument("--out", type=Path, required=verb == "fit")
    given = parser.parse_args()
    try:
        if given.verb == "fit":
            _fit(given.record, given.out)
        elif given.verb == "compare":
            _compare(given.record)
        else:
            _predict(given.model, given.record, given.out)
    except (OSError, ValueError, KeyError, TypeError) as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
