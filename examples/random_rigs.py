"""Which compensation is best on rigs whose friction and inertia it does not know.

tools/in_environment python examples/random_rigs.py    # draws output/examples/random_rigs.png
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import furuta

CANDIDATES = ("none", "coulomb", "lugre", "recommended")
rigs = furuta.random_rigs(24, seed=1)
runs = furuta.compare(candidates=CANDIDATES, rigs=rigs, keep_runs=True).runs
figure, axis = plt.subplots(figsize=(7, 4.5), layout="constrained")
for name in CANDIDATES:
    sizes = np.sort(runs["phi_peak_to_peak_rad"][runs["candidate"] == name])
    axis.semilogx(sizes, np.arange(1, len(sizes) + 1), drawstyle="steps-post", label=name)
    print(f"{name}: median {np.median(sizes):.4f} rad, worst rig {sizes.max():.4f} rad")
axis.set(xlabel="arm, peak to peak [rad]", ylabel="rigs at or below")
axis.grid(alpha=0.3)
axis.legend()
Path("output/examples").mkdir(parents=True, exist_ok=True)
figure.savefig("output/examples/random_rigs.png", dpi=110)

# prints
# none: median 0.4825 rad, worst rig 0.6843 rad
# coulomb: median 0.0468 rad, worst rig 0.2053 rad
# lugre: median 0.2158 rad, worst rig 0.3801 rad
# recommended: median 0.0032 rad, worst rig 0.0055 rad
