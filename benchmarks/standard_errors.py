"""Do standard errors hold? Random rigs with the faults of real ones, each fitted to one recording.

    tools/in_environment python benchmarks/standard_errors.py --rigs 200

The rigs are those of furuta_ws/tests/random_rigs.py: waves, tilt, ceilings, unequal friction, 6 s
under 1 to 6 V, five kinds of command in turn. For each value: how often the truth lies within two
standard errors, the median deviation in standard errors, which shows a bias, and the median
standard error.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

from furuta_identification.fitting.identify import identify
from furuta_identification.fitting.report import summary
from furuta_identification.preparation.options import Options
from furuta_model.parameters import ParameterError

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "furuta_ws" / "tests"))

from random_rigs import Rig, sampled  # type: ignore[import-not-found]

ERRORS = 2.0


def truth(rig: Rig) -> dict[str, float]:
    """True values of what `identify` reports."""
    level = 0.5 * (rig.forward + rig.backward)
    return {
        "alpha": rig.alpha,
        "beta": rig.beta,
        "gamma": rig.gamma,
        "delta": rig.delta,
        "natural_frequency_rad_s": float(np.sqrt(rig.delta / rig.beta)),
        "viscous": rig.viscous,
        "coulomb": level,
        "asymmetry": 0.5 * (rig.forward - rig.backward) / level,
        "pendulum_viscous": rig.pendulum_viscous,
    }


def study(seed: int) -> dict[str, tuple[float, float]]:
    """Deviation from the truth in standard errors and relative error [%] of what is determined."""
    rig, _, recording = sampled(seed)
    found = summary(identify([recording], Options()))
    errors = found["standard_errors"]
    return {
        name: ((found[name] - value) / errors[name], 100.0 * errors[name] / abs(value))
        for name, value in truth(rig).items()
        if found[name] is not None and errors[name] is not None
    }


def main() -> None:
    """Fit the rigs and print a line for each, then one for each value."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])  # type: ignore[union-attr]
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first rig")
    options = parser.parse_args()
    found: dict[str, list[tuple[float, float]]] = defaultdict(list)
    for seed in range(options.first, options.first + options.rigs):
        try:
            values = study(seed)
        except ParameterError as error:
            print(f"{seed}: asked: {error}", flush=True)
            continue
        print(
            f"{seed}:",
            {name: round(float(each[0]), 1) for name, each in values.items()},
            flush=True,
        )
        for name, each in values.items():
            found[name].append(each)
    print(f"{'value':26}{'number':>8}{'within':>9}{'median':>9}{'error':>9}")
    found["all"] = [each for rows in found.values() for each in rows]
    for name, rows in found.items():
        deviations, errors = np.array(rows).T
        within = 100.0 * np.mean(np.abs(deviations) <= ERRORS)
        middle = f"{np.median(deviations):9.2f}{np.median(errors):8.2f}%"
        print(f"{name:26}{len(rows):8d}{within:8.1f}%{middle}")


if __name__ == "__main__":
    main()
