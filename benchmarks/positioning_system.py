"""Friction of the positioning system EMPS: fits, comparison of laws, prediction of a test record.

    tools/in_environment python benchmarks/positioning_system.py fit train.csv --out emps.json
    tools/in_environment python benchmarks/positioning_system.py compare train.csv
    tools/in_environment python benchmarks/positioning_system.py predict emps.json test.csv

A record is a CSV table: time [s], position [m], reference [m], motor voltage signal [V]. The error
is that of the free run: the model gets the voltage of the whole record, and the position only at
the start. The fit is Levenberg-Marquardt's least squares on that error.

The offset of the force drifts during the training record. Another record need not drift in the same
way. So a linear drift is fitted with the other parameters, which it would bias otherwise, but
predictions leave it out: they have the mean offset of the training record.
"""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
from positioning_model import Joint, Record, error_mm, predict, read_record
from scipy.optimize import least_squares

# Step of each parameter for finite differences: free runs that stick are rough at smaller ones.
STEPS = {
    "mass": 0.05,
    "viscous": 0.05,
    "coulomb": 5e-3,
    "direction": 0.05,
    "offset": 2e-3,
    "level_slope": 0.03,
    "spring": 0.03,
    "drift": 3e-4,
    "delay": 1e-4,
    "stiction": 0.03,
    "asymmetry": 3e-4,
    "load": 3e-4,
    "stiffness": 1e3,
}
START = Joint(mass=93.0, viscous=193.0, coulomb=21.6)
BODY = ("mass", "viscous", "coulomb", "offset")
# The chosen law, and the others: the parameters that are fitted. The drift is fitted too.
CHOSEN = (*BODY, "direction", "level_slope")
LAWS: dict[str, tuple[str, ...]] = {
    "Coulomb, viscous, offset (published form)": BODY,
    "Coulomb friction by direction": (*BODY, "asymmetry"),
    "viscous friction by direction": (*BODY, "direction"),
    "the same, level along the travel (chosen)": CHOSEN,
    "chosen, spring": (*CHOSEN, "spring"),
    "chosen, delay": (*CHOSEN, "delay"),
    "chosen, Coulomb friction by direction": (*CHOSEN, "asymmetry"),
    "chosen, Stribeck": (*CHOSEN, "stiction"),
    "chosen, load": (*CHOSEN, "load"),
    "chosen, LuGre": (*CHOSEN, "stiffness"),
}
# Values of the start of a law that differ from START.
STARTS = {"stiffness": 2e5}
LOWEST = {"delay": 0.0, "stiffness": 1e4}
# Sticking makes the error rough, so the fit restarts from its result.
STARTS_OF_FIT, EVALUATIONS = 2, 30
# Change of the motion [mm, root of the sum of squares] by a step of a parameter that shows nothing.
FLAT = 1e-6
# Blocks of time from whose scatter the errors are found [s].
BLOCK = 1.0


def fit(record: Record, names: tuple[str, ...], start: Joint = START) -> Joint:
    """The joint with the smallest error of the free run; all else is that of ``start``."""
    start = start._replace(**{name: value for name, value in STARTS.items() if name in names})
    first = np.array([getattr(start, name) for name in names])
    steps = np.array([STEPS[name] for name in names])

    def residuals(scaled: np.ndarray) -> np.ndarray:
        return 1e3 * (
            predict(_joint(start, names, first + scaled * steps), record) - record.position
        )

    solution = np.zeros(len(names))
    for _ in range(STARTS_OF_FIT):
        slopes = _differences(residuals, solution)
        solution = least_squares(
            residuals,
            solution,
            jac=lambda scaled: _differences(residuals, scaled),
            method="lm",
            x_scale=1.0 / np.maximum(np.linalg.norm(slopes, axis=0), 1e-6),
            ftol=1e-5,
            max_nfev=EVALUATIONS,
        ).x
    slopes = np.linalg.norm(_differences(residuals, solution), axis=0)
    flat = [name for name, slope in zip(names, slopes, strict=True) if slope < FLAT]
    if flat:
        sys.exit(
            f"error: the record does not tell {', '.join(flat)}: the motion does not depend on it"
        )
    return _joint(start, names, first + solution * steps)


def without_drift(joint: Joint, record: Record) -> Joint:
    """The joint for another record: without the drift, at the offset that suits this one best."""
    return fit(record, ("offset",), joint._replace(drift=0.0))


def _differences(residuals: Callable[[np.ndarray], np.ndarray], scaled: np.ndarray) -> np.ndarray:
    """Central differences with a step of one (n, k)."""
    unit = np.eye(len(scaled))
    return np.column_stack(
        [0.5 * (residuals(scaled + step) - residuals(scaled - step)) for step in unit]
    )


def standard_errors(joint: Joint, record: Record, names: tuple[str, ...]) -> dict[str, float]:
    """From the scatter of the slopes between blocks of time (sandwich estimate)."""
    residuals = record.position - predict(joint, record)
    here = np.array([getattr(joint, name) for name in names])
    steps = np.array([STEPS[name] for name in names])
    slopes = _differences(
        lambda x: predict(_joint(joint, names, here + x * steps), record), 0.0 * here
    )
    slopes /= steps
    inverse = np.linalg.pinv(slopes.T @ slopes)
    size = max(1, round(BLOCK / record.step))
    blocks = [slice(begin, begin + size) for begin in range(0, len(residuals), size)]
    scores = np.array([slopes[block].T @ residuals[block] for block in blocks])
    errors = np.sqrt(np.diag(inverse @ scores.T @ scores @ inverse))
    return dict(zip(names, (float(error) for error in errors), strict=True))


def _joint(start: Joint, names: tuple[str, ...], vector: np.ndarray) -> Joint:
    values = {n: max(float(x), LOWEST.get(n, -np.inf)) for n, x in zip(names, vector, strict=True)}
    return start._replace(**values)


def _fit(file: Path, out: Path) -> None:
    record, names = read_record(file), (*CHOSEN, "drift")
    begin = perf_counter()
    joint = fit(record, names)
    seconds = perf_counter() - begin
    errors = standard_errors(joint, record, names)
    for name in names:
        print(f"{name:20} {getattr(joint, name):12.6g} ± {errors[name]:.2g}")
    print(f"error of the free run with the drift {error_mm(joint, record):.3f} mm")
    predicting = without_drift(joint, record)
    print(f"without it, as for another record {error_mm(predicting, record):.3f} mm")
    print(f"fitted in {seconds:.1f} s")
    out.write_text(json.dumps({"joint": predicting._asdict(), "standard_errors": errors}, indent=1))


def _compare(file: Path) -> None:
    """Each law is fitted to a half and predicts the other, of which only the offset is fitted."""
    record = read_record(file)
    middle = len(record.time) // 2
    halves = record.part(0, middle), record.part(middle, len(record.time))
    print(
        f"{'law':44}{'parameters':>11}{'1 to 2':>8}{'2 to 1':>8}{'whole':>8}{'no drift':>10}   [mm]"
    )
    for name, free in LAWS.items():
        held_out = [_held_out(fit(a, free), b) for a, b in (halves, halves[::-1])]
        whole = fit(record, (*free, "drift"))
        sizes = [*held_out, error_mm(whole, record), error_mm(without_drift(whole, record), record)]
        print(f"{name:44}{len(free):11d}" + "".join(f"{size:8.2f}" for size in sizes), flush=True)


def _held_out(joint: Joint, half: Record) -> float:
    """Error [mm] of the free run over a half with its own offset."""
    return error_mm(fit(half, ("offset",), joint), half)


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
        of_verb = verbs.add_parser(verb)
        if verb == "predict":
            of_verb.add_argument("model", type=Path)
        of_verb.add_argument("record", type=Path)
        if verb != "compare":
            of_verb.add_argument("--out", type=Path, required=verb == "fit")
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
