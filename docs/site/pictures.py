"""Draws the pictures of the pages anew: ``python docs/site/pictures.py [NAME ...]``.

Each picture comes from its command or function below. ``view.png`` shows a page in a browser:
``furuta_ws/tests/view_picture.py`` makes it.
"""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from drawing import draw_pendulum
from friction_curves import draw_friction_laws
from pages import ROOT
from paper_figures import draw_experiment
from animations import draw_compensation, draw_swing_up

DOCS = ROOT / "docs"
# Arguments of ``furuta`` by picture. OUT is the picture, DIR a folder in which it appears.
COMMANDS = {
    "atlas.png": "theorem fold --out OUT",
    "axis.png": "axis --inertia 0.01 --friction "
    "alpha0=0.1,alpha1=0.1,stribeck_velocity=0.1,viscous=0.005 --pid 1 2 0.08 --out OUT",
    "branch.png": "limit-cycle --over viscous=0:0.3 --out OUT",
    "comparison.png": "compare --rigs 1000 --out OUT",
    "demo.png": "demo --out DIR",
    "describing_function.png": "limit-cycle --predict --law lugre --out OUT",
    "limit_cycle.png": "limit-cycle --out OUT",
    "map.png": "limit-cycle --over omega1=1:15 --over zeta1=0.05:1.5 --out OUT",
    "nyquist.png": "linearize --figure-4 --out OUT",
}
# Functions that draw the others.
DRAWINGS: dict[str, Callable[[Path], None]] = {
    "compensation.gif": draw_compensation,
    "fig9.png": partial(draw_experiment, "fig9"),
    "friction_curves.png": draw_friction_laws,
    "pendulum.png": draw_pendulum,
    "swing-up.gif": draw_swing_up,
    "swing-up.png": draw_swing_up,
}


def draw(name: str) -> None:
    """Draw one picture of ``docs/`` anew; the old one stays if that fails."""
    if name in DRAWINGS:
        DRAWINGS[name](DOCS / name)
        return
    with tempfile.TemporaryDirectory() as folder:
        places = {"OUT": str(Path(folder, name)), "DIR": str(Path(folder, "results"))}
        arguments = [places.get(word, word) for word in COMMANDS[name].split()]
        done = subprocess.run(["furuta", *arguments], stdout=subprocess.DEVNULL, check=False)
        if done.returncode:
            sys.exit(done.returncode)  # the command has said why
        (picture,) = Path(folder).rglob(name)
        shutil.copyfile(picture, DOCS / name)


if __name__ == "__main__":
    for picture in sys.argv[1:] or [*DRAWINGS, *COMMANDS]:
        print(picture, flush=True)
        draw(picture)
