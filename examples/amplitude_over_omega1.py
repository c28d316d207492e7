"""How the pole frequency ω₁ determines the arm's exact limit cycle, for three friction laws.

    tools/in_environment python examples/amplitude_over_omega1.py

It draws output/examples/amplitude_over_omega1.png. The laws differ by little, so the lower axis has
their differences from Coulomb friction.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import furuta

OMEGA1 = np.linspace(3.0, 15.0, 13)  # [rad/s]
sizes = {}
for law in ("coulomb", "stribeck", "lugre"):
    loops = [furuta.make_loop({"omega1": value, "friction.law": law}) for value in OMEGA1]
    sizes[law] = np.array([furuta.limit_cycle(loop).phi_peak_to_peak_rad for loop in loops])
    print(f"{law}: {sizes[law][0]:.3f} rad at 3 rad/s, {sizes[law][-1]:.3f} rad at 15 rad/s")
figure, (above, below) = plt.subplots(2, 1, figsize=(7, 6), sharex=True, layout="constrained")
for law, size in sizes.items():
    above.semilogy(OMEGA1, size, label=law)
    below.plot(OMEGA1, 100.0 * (size / sizes["coulomb"] - 1.0), label=law)
above.set_ylabel("arm, peak to peak [rad]")
below.set(xlabel="ω₁ [rad/s]", ylabel="difference from Coulomb [%]", xlim=(3.0, 15.0))
for axis in (above, below):
    axis.grid(alpha=0.3)
above.legend()
Path("output/examples").mkdir(parents=True, exist_ok=True)
figure.savefig("output/examples/amplitude_over_omega1.png", dpi=110)

# prints
# coulomb: 2.369 rad at 3 rad/s, 0.109 rad at 15 rad/s
# stribeck: 2.371 rad at 3 rad/s, 0.106 rad at 15 rad/s
# lugre: 2.364 rad at 3 rad/s, 0.106 rad at 15 rad/s
