"""Draws the pictures of the pages anew: ``python docs/site/pictures.py [NAME ...]``.

Each picture comes from its command, function or example below. Those of pages in a browser come
from ``furuta_ws/tests``: ``view_picture.py`` makes ``view.png``, ``page_picture.py`` the others.
"""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import furuta
from furuta.figures.figure import save_figure
from furuta.settings.settings import load_settings, loop
from furuta.studies.swing_up import swing_up_settings

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
# Arguments of ``furuta`` by picture. OUT is the picture, DIR a folder in which it appears.
COMMANDS = {
    "axis.png": "axis --inertia 0.01 --friction "
    "alpha0=0.1,alpha1=0.1,stribeck_velocity=0.1,viscous=0.005 --pid 1 2 0.08 --figure OUT",
    "branch.png": "limit-cycle --over viscous=0:0.3 --figure OUT",
    "comparison.png": "compare --rigs 1000 --figure OUT",
    "demo.png": "demo --out DIR",
    "describing_function.png": "limit-cycle --predict --law lugre --figure OUT",
    "limit_cycle.png": "limit-cycle --figure OUT",
    "map.png": "limit-cycle --over omega1=1:15 --over zeta1=0.05:1.5 --figure OUT",
    "nyquist.png": "linearize --figure-4 --figure OUT",
}
# Examples that draw some of the others.
EXAMPLES = {
    "amplitude_over_omega1.png": "amplitude_over_omega1",
    "axis_hunting.png": "axis_hunting",
    "fig5.png": "limit_cycle",
    "fig9.png": "compensations",
    "friction_curves.png": "friction_laws",
    "random_rigs.png": "random_rigs",
}
SECONDS = 8.0  # of the swing-up


def draw_swing_up(path: Path) -> None:
    """Swing the paper's rig with a full-turn encoder up."""
    settings = swing_up_settings(furuta.load_rig("paper_full_turn"))
    run = furuta.simulate(loop(load_settings([], [], settings)), SECONDS)
    save_figure(run.plot, path)


# Functions that draw the others.
DRAWINGS: dict[str, Callable[[Path], None]] = {
    "swing-up.png": draw_swing_up,
}


def draw(name: str) -> None:
    """Draw one picture of ``docs/`` anew; the old one stays if that fails."""
    if name in DRAWINGS:
        DRAWINGS[name](DOCS / name)
        return
    with tempfile.TemporaryDirectory() as folder:
        if name in EXAMPLES:
            command = [sys.executable, str(ROOT / "examples" / f"{EXAMPLES[name]}.py")]
        else:
            places = {"OUT": str(Path(folder, name)), "DIR": str(Path(folder, "results"))}
            command = ["furuta", *(places.get(word, word) for word in COMMANDS[name].split())]
        done = subprocess.run(command, stdout=subprocess.DEVNULL, cwd=folder, check=False)
        if done.returncode:
            sys.exit(done.returncode)  # the command has said why
        (picture,) = Path(folder).rglob(f"{EXAMPLES[name]}.png" if name in EXAMPLES else name)
        shutil.copyfile(picture, DOCS / name)


if __name__ == "__main__":
    for picture in sys.argv[1:] or [*DRAWINGS, *EXAMPLES, *COMMANDS]:
        print(picture, flush=True)
        draw(picture)
