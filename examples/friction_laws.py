"""Friction over the arm's speed in the exact limit cycle of each law.

    tools/in_environment python examples/friction_laws.py

It draws output/examples/friction_laws.png. A law without a bristle sticks at v = 0. With a bristle
(LuGre, Dahl) the friction lags behind the speed.
"""

from pathlib import Path

import matplotlib.pyplot as plt

import furuta
from furuta.quantities import QUANTITIES

LAWS = ("coulomb", "stiction", "stribeck", "lugre", "dahl")
figure, axes = plt.subplots(1, 5, figsize=(13, 3.4), sharex=True, sharey=True, layout="constrained")
for axis, law in zip(axes, LAWS, strict=True):
    loop = furuta.make_loop({"friction.law": law})
    cycle = furuta.limit_cycle(loop)
    motion = cycle.trace()
    axis.plot(motion.state[:, 1], motion.friction, color=QUANTITIES["friction"].light)
    axis.set(title=law, xlabel="arm speed v [rad/s]", xlim=(-0.3, 0.3))
    axis.grid(alpha=0.3)
    print(f"{law}: {cycle.phi_peak_to_peak_rad:.4f} rad, sticks for {cycle.stuck_fraction:.1%}")
axes[0].set_ylabel("friction F [V]")
Path("output/examples").mkdir(parents=True, exist_ok=True)
figure.savefig("output/examples/friction_laws.png", dpi=110)

# prints
# coulomb: 0.5146 rad, sticks for 30.3%
# stiction: 0.5147 rad, sticks for 31.0%
# stribeck: 0.5153 rad, sticks for 32.1%
# lugre: 0.5106 rad, sticks for 19.7%
# dahl: 0.5094 rad, sticks for 12.1%
