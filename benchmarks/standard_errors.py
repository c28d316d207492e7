"""Do standard errors hold? Random rigs or axes, each identified from one simulated recording.

    tools/in_environment python benchmarks/standard_errors.py rigs --number 200
    tools/in_environment python benchmarks/standard_errors.py axes --number 200

``rigs`` are those of furuta_ws/tests/random_rigs.py: waves, tilt, ceilings, unequal friction, 6 s
under 1 to 6 V, five kinds of command in turn. No step of a command with one level shows that the
drive gives less than commanded.

``axes`` are those of furuta_ws/tests/true_axes.py, 20 s with encoders of 500 to 20000 counts and
noise: with and without delay, gravity, spring, stiction, Stribeck friction, unequal friction and
waves. Asymmetry with Coulomb friction alone cannot be told from an offset: the prior of 0.2 covers
it.

``drives`` are those of furuta_ws/tests/driven_axes.py: axes that move as engineers move them, by
S-curves with and without feedforward, jogs, triangles, speed steps, random binary torques and
sines, at 100 to 1000 Hz for 10 to 30 s.

``arms`` are those of furuta_ws/tests/true_arms.py: arms of two to four links of which all joints
move, with and without friction in proportion to gravity, for 20 to 40 s; ``arms-without-geometry``
are the same without their URDF.

For each value it prints how often the truth lies within two standard errors and how often beyond
four, the median deviation in standard errors, which shows a bias, and the median standard error.
"""

import argparse
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from furuta.identification.axis.identify import GRAVITY_TRAVEL, identify_axis
from furuta.identification.bodies.arm_joint import identify_arm_joint
from furuta.identification.identify import identify
from furuta.identification.options import Options
from furuta.identification.regression.equations import has_one_level
from furuta.identification.result.values import values_by_name, verdict
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "furuta_ws" / "tests"))

from driven_axes import MOTIONS, driven_axis  # type: ignore[import-not-found]
from random_rigs import Rig, sampled  # type: ignore[import-not-found]
from true_arms import moved_arm  # type: ignore[import-not-found]
from true_axes import TrueAxis, random_axis  # type: ignore[import-not-found]

NEAR, FAR = 2.0, 4.0
# Of each value, by name: its deviation in standard errors, and the relative standard error [%].
Found = dict[str, tuple[float, float]]


class Judged(NamedTuple):
    """What is said of a recording, the groups that its values count in, and the values."""

    remark: str
    groups: tuple[str, ...]
    found: Found


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


def _compared(
    values: Mapping[str, float], errors: Mapping[str, float], truth: Mapping[str, float]
) -> Found:
    """Values with a standard error, compared with the truth; what it does not name is 0 there."""
    found = {}
    for name, error in errors.items():
        true = truth.get(name, 0.0)
        size = 100.0 * error / abs(true) if true else np.inf
        found[name] = ((values[name] - true) / error, size)
    return found


def rig(seed: int) -> Judged:
    """A rig, whose verdict and commands decide in which groups it counts."""
    sample, _, recording = sampled(seed)
    model = identify([recording], Options())
    values, true = values_by_name(model), truth(sample)
    given = values["standard_errors"]
    errors = {name: given[name] for name in true if given[name] and values[name] is not None}
    usable = verdict([model.predict(each) for each in model.recordings]).usable
    groups = ["all fits"]
    if usable == "yes":
        several = not has_one_level(model.recordings)
        groups += ["usable", "usable, several levels"] if several else ["usable"]
    return Judged(f"usable: {usable}", tuple(groups), _compared(values, errors, true))


def axis(seed: int) -> Judged:
    """An axis; the remark names effects that are reported though it does not have them."""
    sample, _, recording = random_axis(seed)
    return _judged_axis(sample, recording)


def drive(seed: int) -> Judged:
    """An axis under a controller, which also counts in the group of its motion.

    One whose travel does not tell gravity from a spring, or a wave from either, does not count.
    """
    sample, motion, recording = driven_axis(seed)
    judged = _judged_axis(sample, recording)
    travel = float(np.ptp(recording.measured[:, 0]))
    gravity = travel < GRAVITY_TRAVEL and (sample.gravity_sin or sample.gravity_cos)
    if gravity or (sample.wave and sample.order * travel < 2.0 * np.pi):
        return judged._replace(remark="its travel does not tell its effects", groups=())
    return judged._replace(groups=(*judged.groups, *(motion for _ in judged.groups[:1])))


def _judged_axis(sample: TrueAxis, recording: Recording) -> Judged:
    fit, true = identify_axis(recording), sample.values()
    invented = " ".join(name for name in fit.values if not true.get(name))
    remark = f"usable: {fit.usable}{', invented: ' if invented else ''}{invented}"
    groups = ("usable",) if fit.usable == "yes" else ()
    return Judged(remark, groups, _compared(fit.values, fit.standard_errors, true))


def arm(seed: int, geometry: bool = True) -> Judged:
    """A joint of a moving arm, of which all fits that are not useless count."""
    with TemporaryDirectory() as folder:
        urdf = Path(folder) / "arm.urdf"
        _, motion, (recording, others, true) = moved_arm(seed, urdf)
        fit = identify_arm_joint(recording, others, urdf if geometry else None)
    missing = [name for name, value in true.items() if value and name not in fit.values]
    remark = f"usable: {fit.usable}{', not determined: ' if missing else ''}{' '.join(missing)}"
    groups = (f"usable or doubtful, {motion}", "together") if fit.usable != "no" else ()
    return Judged(remark, groups, _compared(fit.values, fit.standard_errors, true))


STUDIES: dict[str, Callable[[int], Judged]] = {
    "rigs": rig,
    "axes": axis,
    "drives": drive,
    "arms": arm,
    "arms-without-geometry": partial(arm, geometry=False),
}


def main() -> None:
    """Fit the recordings and print a line for each, then one for each value."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kind", choices=STUDIES)
    parser.add_argument("--number", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first one")
    given = parser.parse_args()
    remarks = Counter[str]()
    groups: dict[str, dict[str, list[tuple[float, float]]]] = defaultdict(lambda: defaultdict(list))
    begin = time.process_time()
    for seed in range(given.first, given.first + given.number):
        try:
            judged = STUDIES[given.kind](seed)
        except ParameterError as error:
            remarks["asked"] += 1
            print(f"{seed}: asked: {error}", flush=True)
            continue
        remarks[judged.remark] += 1
        rounded = {name: round(float(off), 1) for name, (off, _) in judged.found.items()}
        print(f"{seed}: {judged.remark}; {rounded}", flush=True)
        for group in judged.groups:
            for name, pair in judged.found.items():
                groups[group]["wave" if name[:4] in ("cos ", "sin ") else name].append(pair)
    for title, rows in groups.items():
        print(f"{title:26}{'number':>8}{'within':>9}{'beyond':>9}{'median':>9}{'error':>9}")
        for name, pairs in rows.items() if title not in MOTIONS else ():
            _print(name, pairs)
        _print("together", [pair for pairs in rows.values() for pair in pairs])
    print(f"{time.process_time() - begin:.0f} s of CPU, the simulation included")
    print(*(f"{count:4d} {remark}" for remark, count in remarks.most_common()), sep="\n")


def _print(name: str, pairs: list[tuple[float, float]]) -> None:
    off, errors = np.array(pairs).T
    within, beyond = 100.0 * np.mean(np.abs(off) <= NEAR), 100.0 * np.mean(np.abs(off) > FAR)
    middle = f"{np.median(off):9.2f}{np.median(errors):8.2f}%"
    print(f"{name:26}{len(pairs):8d}{within:8.1f}%{beyond:8.2f}%{middle}")


if __name__ == "__main__":
    main()
