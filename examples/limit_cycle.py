"""Figs 5 and 6 of the paper: the motion of the simulated rig beside the exact limit cycle.

    tools/in_environment python examples/limit_cycle.py    # draws output/examples/limit_cycle.png

The exact cycle has no sensors, samples and noise. In Fig. 6 the friction differs by direction.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import furuta

TITLES = {0.0: "Fig. 5: equal friction", 0.05: "Fig. 6: friction ±5 % by direction"}
LABELS = ("arm φ [rad]", "pendulum θ [rad]", "control u [V]")
figure, axes = plt.subplots(3, 2, figsize=(10, 7), sharex=True, sharey="row", layout="constrained")
for column, (asymmetry, title) in zip(axes.T, TITLES.items(), strict=True):
    loop = furuta.make_loop({"plant.friction.asymmetry": asymmetry})
    rig, cycle = furuta.simulate(loop, 40.0), furuta.limit_cycle(loop)
    exact = cycle.trace()  # from the largest φ on
    settled = rig.time > 40.0 - 5.0 * cycle.period_s
    time, arm = rig.time[settled], rig.state[settled, 0]
    time = time - time[np.argmax(arm)]
    for axis, of_rig, of_cycle in (
        (column[0], arm, exact.state[:, 0]),
        (column[1], rig.state[settled, 2], exact.state[:, 2]),
        (column[2], rig.command[settled], exact.control),
    ):
        axis.plot(time, of_rig, color="tab:blue", lw=4, alpha=0.4, label="simulated rig")
        drawn = np.interp(time, exact.time, of_cycle, period=cycle.period_s)
        axis.plot(time, drawn, color="black", lw=1, label="exact cycle")
    column[0].set(title=title, xlim=(0.0, 4.0))
    column[2].set(xlabel="time [s]", ylim=(-0.4, 0.6))
    predicted = furuta.predict_cycles(loop).cycles[0].phi_peak_to_peak_rad
    print(f"{title}: {arm.min():.3f} to {arm.max():.3f} rad")
    print(f"   exact {exact.state[:, 0].min():.3f} to {exact.state[:, 0].max():.3f} rad")
    print(f"   by the describing function {predicted:.3f} rad peak to peak")
for axis, label in zip(axes[:, 0], LABELS, strict=True):
    axis.set_ylabel(label)
axes[2, 1].legend(loc="upper right", ncols=2)
Path("output/examples").mkdir(parents=True, exist_ok=True)
figure.savefig("output/examples/limit_cycle.png", dpi=110)

# prints
# Fig. 5: equal friction: -0.256 to 0.255 rad
#    exact -0.255 to 0.255 rad
#    by the describing function 0.637 rad peak to peak
# Fig. 6: friction ±5 % by direction: -0.246 to 0.265 rad
#    exact -0.245 to 0.265 rad
#    by the describing function 0.637 rad peak to peak
