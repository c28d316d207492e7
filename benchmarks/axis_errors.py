"""Do the standard errors of an identified axis hold? Random axes, each from one recording of 20 s.

    tools/in_environment python benchmarks/axis_errors.py --axes 200

The axes are those of furuta_ws/tests/true_axes.py, moved in steps of 0.01 ms: with and without
delay, gravity, spring, stiction, Stribeck friction, unequal friction, a wave of the torque;
encoders of 500 to 20000 counts; 0.2 % noise of the recorded torque. For each value: how often the
truth lies within two standard errors, and how often beyond four, among the axes that the verdict
calls usable. Then how often each effect is reported though the axis does not have it. Asymmetry
with Coulomb friction alone cannot be told from an offset: the prior of 0.2 covers it.
"""

import argparse
import sys
from collections import Counter, defaultdict
from pathlib import Path
from time import thread_time

import numpy as np

from furuta_identification.axis.identify import AxisFit, identify_axis
from furuta_model.parameters import ParameterError

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "furuta_ws" / "tests"))

from true_axes import TrueAxis, random_axis  # type: ignore[import-not-found]

NEAR, FAR = 2.0, 4.0


def deviations(axis: TrueAxis, fit: AxisFit) -> dict[str, float]:
    """How far each reported value is from the truth, in standard errors."""
    truth = axis.values()
    return {
        name: (value - truth.get(name, 0.0)) / fit.standard_errors[name]
        for name, value in fit.values.items()
    }


def invented(axis: TrueAxis, fit: AxisFit) -> list[str]:
    """Effects that are reported though the axis does not have them, without the number of waves."""
    truth = axis.values()
    names = [name for name in fit.values if not truth.get(name)]
    return sorted({"wave" if name[:4] in ("cos ", "sin ") else name for name in names})


def main() -> None:
    """Fit the axes and print a line for each, then the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--axes", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first axis")
    options = parser.parse_args()
    verdicts, extra = Counter[str](), Counter[str]()
    found: dict[str, list[float]] = defaultdict(list)
    seconds = []
    for seed in range(options.first, options.first + options.axes):
        axis, _, recording = random_axis(seed)
        begin = thread_time()
        try:
            fit = identify_axis(recording)
        except ParameterError as error:
            verdicts["refused"] += 1
            print(f"{seed}: refused: {error}", flush=True)
            continue
        seconds.append(thread_time() - begin)
        verdicts[fit.usable] += 1
        off, more = deviations(axis, fit), invented(axis, fit)
        extra.update(more)
        far = {name: round(float(z), 1) for name, z in off.items() if abs(z) > NEAR}
        print(
            f"{seed}: {seconds[-1]:.1f} s, {fit.usable}, left {fit.left:.2f}, {far}",
            *more,
            flush=True,
        )
        for name, z in off.items() if fit.usable == "yes" else ():
            found["wave" if name[:4] in ("cos ", "sin ") else name].append(abs(z))
    _print(found)
    print(dict(verdicts), f"invented: {dict(extra)}")
    print(f"{np.mean(seconds):.2f} s of CPU an axis, at most {np.max(seconds):.1f} s")


def _print(found: dict[str, list[float]]) -> None:
    """A line for each value, and one for all."""
    print(f"{'usable':20}{'number':>8}{'within':>9}{'beyond':>9}")
    together = [z for values in found.values() for z in values]
    for name, values in [*found.items(), ("together", together)]:
        within, beyond = (
            100.0 * np.mean(part) for part in (np.less(values, NEAR), np.greater(values, FAR))
        )
        print(f"{name:20}{len(values):8d}{within:8.1f}%{beyond:8.2f}%")


if __name__ == "__main__":
    main()
