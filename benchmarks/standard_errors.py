"""Do standard errors hold? Random rigs with the faults of real ones, each fitted to one recording.

    tools/in_environment python benchmarks/standard_errors.py --rigs 200

The rigs are those of furuta_ws/tests/random_rigs.py: waves, tilt, ceilings, unequal friction, 6 s
under 1 to 6 V, five kinds of command in turn. For each value: how often the truth lies within two
standard errors, the median deviation in standard errors, which shows a bias, and the median
standard error; for all fits, for those that the verdict calls usable, and for those of them whose
commands have more than one level: no step shows that the drive gives less than commanded.
"""

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
from rigs_from_recordings import parsed

from furuta_identification.identify import identify
from furuta_identification.options import Options
from furuta_identification.regression.equations import has_one_level
from furuta_identification.result.report import summary, verdict
from furuta_model.parameters import ParameterError

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "furuta_ws" / "tests"))

from random_rigs import Rig, sampled  # type: ignore[import-not-found]

ERRORS = 2.0
# Of each value, by name, its deviation and its error for each rig.
Found = dict[str, list[tuple[float, float]]]


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


def study(seed: int) -> tuple[str, bool, dict[str, tuple[float, float]]]:
    """The verdict; whether the command has one level; how far values are from the truth.

    Of each value the deviation in standard errors, and the relative standard error [%].
    """
    rig, _, recording = sampled(seed)
    model = identify([recording], Options())
    values = summary(model)
    errors = values["standard_errors"]
    usable = verdict([model.predict(recording) for recording in model.recordings])["usable"]
    return (
        usable,
        has_one_level(model.recordings),
        {
            name: ((values[name] - value) / errors[name], 100.0 * errors[name] / abs(value))
            for name, value in truth(rig).items()
            if values[name] is not None and errors[name] is not None
        },
    )


def main() -> None:
    """Fit the rigs and print a line for each, then one for each value."""
    options = parsed(__doc__, 200)
    seeds = range(options.first, options.first + options.rigs)
    groups: dict[str, Found] = {
        "all fits": defaultdict(list),
        "usable": defaultdict(list),
        "usable, several levels": defaultdict(list),
    }
    for seed in seeds:
        try:
            judged, one_level, values = study(seed)
        except ParameterError as error:
            print(f"{seed}: asked: {error}", flush=True)
            continue
        rounded = {name: round(float(pair[0]), 1) for name, pair in values.items()}
        levels = "one level" if one_level else "several levels"
        print(f"{seed}: usable: {judged}, {levels};", rounded, flush=True)
        usable = judged == "yes"
        for group, counts in zip(
            groups.values(), (True, usable, usable and not one_level), strict=True
        ):
            for name, pair in values.items():
                if counts:
                    group[name].append(pair)
    for title, group in groups.items():
        _print(title, group)


def _print(title: str, group: Found) -> None:
    print(f"{title:26}{'number':>8}{'within':>9}{'median':>9}{'error':>9}")
    together = [pair for rows in group.values() for pair in rows]
    for name, rows in [*group.items(), ("together", together)]:
        if rows:
            deviations, errors = np.array(rows).T
            within = 100.0 * np.mean(np.abs(deviations) <= ERRORS)
            middle = f"{np.median(deviations):9.2f}{np.median(errors):8.2f}%"
            print(f"{name:26}{len(rows):8d}{within:8.1f}%{middle}")


if __name__ == "__main__":
    main()
