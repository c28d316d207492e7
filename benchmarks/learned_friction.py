"""What the recommended compensation learns, and where it helps, on the plant of late_rigs.py.

    tools/in_environment python benchmarks/learned_friction.py presliding
    tools/in_environment python benchmarks/learned_friction.py plane docs/belts.png

``presliding``: rigid rigs with drives on time. For each law and level, the learned presliding after
40 s over the true one, which is the level over the stiffness of the bristle, and the time after
which it stays within 20 % of its end. Friction that sticks has none; there the learned one is given
in mrad. Each line has the median of ten pendulums and noises.

``plane``: the arm's swing over that without compensation, by the frequency of a belt and its gap.
Friction is that of the file and sticks, half of it on the arm; the drive has a delay of 5 ms and a
lag of 10 ms, which the file states.
"""

import argparse
from math import inf, nan
from pathlib import Path

import matplotlib as mpl
import numpy as np
from late_rigs import COUNT, DT, RUN, LateRig, RigLoop, about_body, loop_told, swing
from matplotlib import pyplot
from matplotlib.colors import ListedColormap
from two_masses import LAWS, Belt, DryFriction, two_masses

import furuta
from furuta_model.friction.parameters import Friction
from furuta_model.pendulum import FurutaPendulum

KNOWN = Friction()
LEVELS, STIFFNESSES, REPEATED = (0.5, 1.0, 2.0), (0.5, 1.0, 2.0), 10
STICKING = ("coulomb", "stiction", "stribeck")
# Of the presliding: seconds of a run, seconds between two values, relative change of a settled one.
SECONDS, INTERVAL, SETTLED = 40.0, 0.2, 0.2
FREQUENCIES = (15.0, 20.0, 25.0, 30.0, 40.0, 50.0, 70.0, 100.0, 150.0)
GAPS = (0.0, 1e-3, 2e-3, 5e-3, 10e-3, 17e-3)
DELAY, LAG = 0.005, 0.010


def friction(law: str, level: float, stiffness: float = 1.0) -> DryFriction:
    """Friction of the file's levels and stiffness, each times a factor."""
    return DryFriction(
        law=LAWS.index(law),
        forward=level * KNOWN.alpha0,
        backward=level * KNOWN.alpha0,
        added=level * KNOWN.alpha1,
        stribeck_velocity=KNOWN.stribeck_velocity,
        stiffness=stiffness * KNOWN.sigma0,
        damping=KNOWN.sigma1,
    )


def learned(law: str, level: float, stiffness: float, seed: int) -> tuple[float, float]:
    """The presliding [rad] after a run, and the time [s] after which it hardly changes."""
    body = about_body(np.random.default_rng(seed))
    plant = two_masses(body, friction(law, level, stiffness), dt=DT)
    rig = LateRig("", plant, elastic=False, level=level, right=(0.0, 0.0), wrong=(0.0, 0.0))
    loop, found = RigLoop(rig, loop_told(0.0, 0.0), (seed, RUN)), []
    for _ in range(round(SECONDS / INTERVAL)):
        loop.run(INTERVAL)
        found.append(loop.presliding)
    changed = np.flatnonzero(np.abs(np.array(found) / found[-1] - 1.0) > SETTLED)
    return found[-1], INTERVAL * (1 + changed[-1]) if len(changed) else 0.0


def print_presliding() -> None:
    """A line for each law, level and stiffness."""
    print(f"{'law':14}{'level':>6}{'stiffness':>11}{'true [mrad]':>13}{'learned':>9}{'s':>6}")
    for law in LAWS:
        for level in LEVELS:
            for stiffness in STIFFNESSES if law not in STICKING else (1.0,):
                runs = [learned(law, level, stiffness, seed) for seed in range(REPEATED)]
                x_s, seconds = np.median(runs, axis=0)
                added = KNOWN.alpha1 if law == "lugre" else 0.0
                true = level * (KNOWN.alpha0 + added) / (stiffness * KNOWN.sigma0)
                shown = nan if law in STICKING else 1e3 * true
                print(
                    f"{law:14}{level:6.1f}{stiffness:11.1f}{shown:13.2f}"
                    f"{1e3 * x_s:9.2f}{seconds:6.1f}"
                )


def plane(senses_motor: bool) -> tuple[np.ndarray, np.ndarray]:
    """The swing [rad] without and with compensation, by gap and frequency."""
    none = furuta.make_loop({"compensation": "none"})
    swings = np.empty((2, len(GAPS), len(FREQUENCIES)))
    for i, gap in enumerate(GAPS):
        for k, frequency in enumerate(FREQUENCIES):
            belt = Belt(frequency, 0.03, 0.5, gap, 0.5, senses_motor)
            plant = two_masses(FurutaPendulum(), friction("stiction", 1.0), belt, DELAY, LAG, DT)
            rig = LateRig("", plant, True, 1.0, (DELAY, LAG), (DELAY, LAG))
            for m, loop in enumerate((none, loop_told(DELAY, LAG))):
                swings[m, i, k] = np.median([swing(rig, loop, seed) for seed in range(3)])
    return swings[0], swings[1]


def draw_plane(file: Path) -> None:
    """Draw both planes: the swing in each cell [mrad], and what the compensation does."""
    effects = (
        "within a count",
        "less than without",
        "no less",
        "falls where none stands",
        "both fall",
    )
    colours = ListedColormap(["#4c9f70", "#b7dba4", "#f2e394", "#d1495b", "#bbbbbb"])
    figure, axes = pyplot.subplots(1, 2, figsize=(11, 4.4), sharey=True, layout="constrained")
    for axis, senses_motor in zip(axes, (False, True), strict=True):
        none, some = plane(senses_motor)
        effect = np.select(
            [(some == inf) & (none == inf), some == inf, some <= COUNT, some < none - COUNT],
            [4, 3, 0, 1],
            2,
        )
        image = axis.imshow(
            effect, cmap=colours, vmin=-0.5, vmax=4.5, origin="lower", aspect="auto"
        )
        for (i, k), value in np.ndenumerate(some):
            text = "falls" if value == inf else f"{1e3 * value:.0f}"
            axis.text(k, i, text, ha="center", va="center", fontsize=8)
        axis.set_xticks(range(len(FREQUENCIES)), [f"{f:g}" for f in FREQUENCIES])
        axis.set_yticks(range(len(GAPS)), [f"{1e3 * gap:g}" for gap in GAPS])
        axis.set_xlabel("frequency of the belt [Hz]")
        axis.set_title(f"sensors on the {'motor' if senses_motor else 'arm'}")
    axes[0].set_ylabel("gap [mrad]")
    bar = figure.colorbar(image, ax=axes, ticks=range(len(effects)))
    bar.ax.set_yticklabels(effects)
    figure.suptitle("swing of the arm with the recommended compensation [mrad]")
    figure.savefig(file, dpi=110)


def main() -> None:
    """Print the table or draw the picture."""
    mpl.use("Agg")
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("presliding", "plane"))
    parser.add_argument("file", nargs="?", type=Path, default=Path("output/belts.png"))
    given = parser.parse_args()
    if given.what == "presliding":
        print_presliding()
    else:
        draw_plane(given.file)


if __name__ == "__main__":
    main()
