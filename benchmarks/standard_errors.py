"""Do standard errors hold, and is nothing refused for a false reason? Logs of an independent truth.

    tools/in_environment python benchmarks/standard_errors.py axes --first 0 --number 150 --jobs 2

``axes`` are those of logged_motions.py; ``loaded`` ones have friction in proportion to the torque.
``servos`` have a loop of their own, every second one with stiction. ``chains`` are the joints of
moving arms (logged_chains.py), joints that move in proportion among them. ``rigs`` are pendulums on
arms that stick (logged_rigs.py).

Each log has a line: its verdict with the reasons, and each value's deviation in standard errors.
Tables follow of all usable fits: how many values lie within two and beyond four standard errors, by
kind of move, by value and by kind of truth. ``invented`` are effects that are reported and do not
exist, ``far`` are values more than 10 % and two standard errors off.
"""

import argparse
import time
from collections import Counter, defaultdict
from collections.abc import Callable
from multiprocessing import Pool
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
from logged_chains import logged_chain
from logged_motions import Logged, logged_axis, logged_servo
from logged_rigs import logged_rig

from furuta.identification.axis.identify import identify_axis
from furuta.identification.bodies.arm_joint import identify_arm_joint
from furuta.identification.bodies.servo import identify_servo
from furuta.identification.estimates import Estimates
from furuta.identified_models import identify
from furuta_model.parameters import ParameterError
from furuta_recordings.recording import Recording

NEAR, FAR, PART = 2.0, 4.0, 0.1
# What every axis has, so that a report of it is not invented.
ALWAYS = ("offset", "delay")


class Judged(NamedTuple):
    """A fit: verdict, what it counts as, reasons, deviations by name, and what is wrong of it."""

    seed: int
    usable: str
    groups: tuple[str, ...]
    reasons: str
    off: dict[str, float]
    invented: tuple[str, ...]
    far: tuple[str, ...]
    seconds: float


def recording_of(log: Logged, joint: str = "axis") -> Recording:
    """A log as the identification reads it."""
    measured = np.full((len(log.time), 4), np.nan)
    measured[:, 0] = log.position
    return Recording(joint, log.time, measured, log.time, log.command, joint=joint)


def _judged(
    seed: int, log: Logged, fit: Callable[[], Estimates], only_true: bool = False
) -> Judged:
    """What a fit says of a log, beside what is true."""
    begin = time.process_time()
    try:
        found = fit()
    except ParameterError as refusal:
        spent = time.process_time() - begin
        return Judged(seed, "refused", (log.kind, *log.traits), str(refusal), {}, (), (), spent)
    spent = time.process_time() - begin
    off, invented, far = {}, [], []
    for name, error in found.standard_errors.items():
        if only_true and name not in log.values:
            continue
        true = log.values.get(name, 0.0)
        wrong = found.values[name] - true
        off[name] = float(wrong / error)
        if not true and name not in ALWAYS:
            invented.append(name)
        if abs(wrong) > max(NEAR * error, PART * abs(true)) and name not in ALWAYS:
            far.append(name)
    reasons = "; ".join(found.verdict.reasons)
    groups = (log.kind, *log.traits)
    return Judged(
        seed, found.verdict.usable, groups, reasons, off, tuple(invented), tuple(far), spent
    )


def axis(seed: int) -> Judged:
    """An axis."""
    log = logged_axis(seed)
    return _judged(seed, log, lambda: identify_axis(recording_of(log)))


def loaded(seed: int) -> Judged:
    """An axis whose friction grows with the torque."""
    log = logged_axis(seed, loaded=True)
    return _judged(seed, log, lambda: identify_axis(recording_of(log)))


def servo(seed: int) -> Judged:
    """A servo, every second one with stiction."""
    log = logged_servo(seed, bool(seed % 2))
    return _judged(seed, log, lambda: identify_servo(recording_of(log)))


def chain(seed: int) -> Judged:
    """A joint of a moving arm."""
    log, others, urdf = logged_chain(seed)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "arm.urdf"
        file.write_text(urdf, encoding="utf-8")
        moving = [recording_of(each, f"joint{k}") for k, each in others.items()]
        own = recording_of(log, f"joint{logged_joint(log)}")
        return _judged(seed, log, lambda: identify_arm_joint(own, moving, file))


def logged_joint(log: Logged) -> int:
    """The number of the joint of a log."""
    return int(log.traits[0].removeprefix("joint "))


def rig(seed: int) -> Judged:
    """A rig: the values that the truth has, too."""
    log, measured = logged_rig(seed)
    recording = Recording("rig", log.time, measured, log.time, log.command, in_radians=True)
    return _judged(seed, log, lambda: identify(recording), only_true=True)


STUDIES: dict[str, Callable[[int], Judged]] = {
    "axes": axis,
    "loaded": loaded,
    "servos": servo,
    "chains": chain,
    "rigs": rig,
}


def main() -> None:
    """Fit the logs, print a line for each, then the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("study", choices=STUDIES)
    parser.add_argument("--first", type=int, default=0, help="seed of the first one")
    parser.add_argument("--number", type=int, default=60)
    parser.add_argument("--jobs", type=int, default=1)
    given = parser.parse_args()
    seeds = range(given.first, given.first + given.number)
    with Pool(given.jobs) as pool:
        found = []
        for each in pool.imap(STUDIES[given.study], seeds):
            found.append(each)
            off = " ".join(f"{name}:{value:.1f}" for name, value in each.off.items())
            print(
                f"{each.seed} {each.usable} {each.seconds:.1f} s [{', '.join(each.groups)}] {off}",
                flush=True,
            )
            if each.reasons:
                print(f"    {each.reasons}", flush=True)
    print_tables(found)


def print_tables(found: list[Judged]) -> None:
    """Verdicts, coverage by group, and what is invented or far off."""
    counts = Counter(each.usable for each in found)
    print(*(f"{usable} {count}" for usable, count in counts.items()), sep=", ")
    for usable in ("yes", "doubtful"):
        chosen = [each for each in found if each.usable == usable]
        print(f"{usable + ', all':34}{_covered([x for e in chosen for x in e.off.values()])}")
        groups: dict[str, list[float]] = defaultdict(list)
        for each in chosen if usable == "yes" else ():
            for name, off in each.off.items():
                kind = "wave" if name[:4] in ("cos ", "sin ") else name
                for group in (*each.groups, f"value {kind}"):
                    groups[group].append(off)
        for group in sorted(groups):
            print(f"  {group:32}{_covered(groups[group])}")
        for word, names in (("invented", "invented"), ("far", "far")):
            of = [(e.seed, *getattr(e, names)) for e in chosen if getattr(e, names)]
            total = sum(len(row) - 1 for row in of)
            print(f"  {word}: {total} values of {len(of)} fits: {of}")
    seconds = [each.seconds for each in found]
    print(f"CPU of a fit: median {np.median(seconds):.2f} s, together {np.sum(seconds):.0f} s")


def _covered(off: list[float]) -> str:
    if not off:
        return "no values"
    size = np.abs(off)
    near, far = 100.0 * np.mean(size <= NEAR), 100.0 * np.mean(size > FAR)
    return f"{len(off):5d} values, {near:5.1f} % within two, {far:4.1f} % beyond four"


if __name__ == "__main__":
    main()
