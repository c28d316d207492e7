"""Figs 7 to 9 of the paper: what Coulomb, LuGre and tuned LuGre compensation leave of the cycle.

    tools/in_environment python examples/compensations.py

It draws output/examples/compensations.png. Without compensation the arm moves by 0.51 rad.
"""

from math import pi
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import furuta
from furuta.quantities import QUANTITIES

RIG = {"plant.friction.asymmetry": 0.05}  # the motor's friction differs by direction
LABELS = [QUANTITIES[name].axis for name in ("arm", "command", "friction")]
LUGRE = RIG | {"compensation": "lugre"}
# Tuned: the level of each direction as on the rig, and the σ₁ that leaves the least swing.
TUNED = LUGRE | {"friction_observer.asymmetry": 0.05}
dampings = np.linspace(0.5, 3.0, 11)
tried = furuta.sweep({"friction_observer.sigma1": dampings}, furuta.make_loop(TUNED))
best = float(dampings[np.argmin(tried["phi_peak_to_peak_rad"])])
loops = {
    "Fig. 7: Coulomb": furuta.make_loop(RIG | {"compensation": "coulomb"}),
    "Fig. 8: LuGre": furuta.make_loop(LUGRE),
    "Fig. 9: LuGre, tuned": furuta.make_loop(TUNED | {"friction_observer.sigma1": best}),
}
COMMAND, FRICTION, ESTIMATE = (QUANTITIES[name] for name in ("command", "friction", "estimate"))
figure, axes = plt.subplots(3, 3, figsize=(12, 7), sharex=True, sharey="row", layout="constrained")
for column, (title, loop) in zip(axes.T, loops.items(), strict=True):
    run = furuta.simulate(loop, 40.0)
    last = run.time >= 36.0
    time, friction, estimate = run.time[last] - 36.0, run.friction, run.friction_estimate
    true = {"color": FRICTION.light, "lw": 2.4, "alpha": 0.7, "label": "true F"}
    column[0].plot(time, run.state[last, 0], color=QUANTITIES["arm"].light)
    column[1].plot(time, run.command[last], color=COMMAND.light, lw=0.8)
    column[2].plot(time, friction[last], **true)
    column[2].plot(time, estimate[last], color=ESTIMATE.light, lw=0.8, label=ESTIMATE.title)
    column[0].set_title(title)
    column[2].set(xlabel="time [s]", xlim=(0.0, 4.0), ylim=(-0.27, 0.4))
    print(f"{title}: {np.ptp(run.state[run.time >= 20.0, 0]):.3f} rad")
print(f"one count of the encoder: {2.0 * pi / loop.plant.sensors.encoder_counts:.3f} rad")
for axis, label in zip(axes[:, 0], LABELS, strict=True):
    axis.set_ylabel(label)
axes[2, 2].legend(loc="upper center", ncols=2)
Path("output/examples").mkdir(parents=True, exist_ok=True)
figure.savefig("output/examples/compensations.png", dpi=110)

# prints
# Fig. 7: Coulomb: 0.028 rad
# Fig. 8: LuGre: 0.020 rad
# Fig. 9: LuGre, tuned: 0.013 rad
# one count of the encoder: 0.025 rad
