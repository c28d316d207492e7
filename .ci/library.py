"""Tries an installed wheel: the lines of README, and verbs that need no ROS, in an empty folder.

python .ci/library.py    with the Python into which the wheel is installed
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import furuta

# Verbs with a key of their JSON.
VERBS = {
    "simulate --seconds 10 --ideal-sensors": "phi_peak_to_peak_rad",
    "limit-cycle": "phi_peak_to_peak_rad",
    "linearize": "L",
    "axis --inertia 0.01 --friction alpha0=0.1,alpha1=0.05 --law stiction --pid 2 6 0.12": "kind",
    "export c --out loop": "files",
}


def output_of(verb: str, folder: str) -> str:
    """What a verb prints, run as on the command line."""
    furuta_command = shutil.which("furuta", path=str(Path(sys.executable).parent)) or "furuta"
    command = [furuta_command, *verb.split()]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"furuta {verb}: {done.stderr}")
    return done.stdout


print(f"furuta {furuta.__version__} in {Path(furuta.__file__).parent}, Python {sys.version}")
loop = furuta.make_loop({"omega1": 7.0})
run = furuta.simulate(loop, seconds=60.0)
cycle = furuta.limit_cycle(loop)
result = f"{cycle.phi_peak_to_peak_rad:.3f} rad, {cycle.period_s:.2f} s"
if result != "0.511 rad, 2.37 s":
    sys.exit(f"the exact periodic motion is {result}")
with tempfile.TemporaryDirectory() as empty:
    for each, key in VERBS.items():
        print(f"furuta {each}: {key} {json.loads(output_of(f'{each} --json', empty))[key]}")
    print("furuta page:", output_of("page --no-open", empty))
