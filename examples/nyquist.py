"""Fig. 4 of the paper: which feedbacks u = l·x give a limit cycle, from their Nyquist curves.

    tools/in_environment python examples/nyquist.py    # draws output/examples/nyquist.png

Coulomb friction has −1/N on the negative real axis. Where G(jω) meets it at ω > 0, there is a
cycle. Where G(jω) begins there at ω = 0, the arm rotates.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import furuta

FEEDBACKS = {  # l for (φ, φ̇, θ, θ̇) [V/rad, V s/rad, V/rad, V s/rad]
    "a) u = 60θ + 20θ̇ + 10φ + 4φ̇": (10.0, 4.0, 60.0, 20.0),
    "b) u = 60θ + 20θ̇": (0.0, 0.0, 60.0, 20.0),
    "c) u = 60θ + 20θ̇ + φ̇": (0.0, 1.0, 60.0, 20.0),
    "d) u = 60θ + 20θ̇ + 7φ̇": (0.0, 7.0, 60.0, 20.0),
}
omega = np.geomspace(1e-2, 1e4, 4000)
figure, axes = plt.subplots(2, 2, figsize=(9, 7.5), layout="constrained")
for axis, (title, feedback) in zip(axes.flat, FEEDBACKS.items(), strict=True):
    gain = [-each for each in feedback]  # of u = −L·x
    loop = furuta.make_loop({"gain": gain, "plant.friction.law": "coulomb"})
    g = furuta.linearize(loop)[1, 0]  # from −F to φ̇
    curve = g(1j * omega)
    size = np.abs(curve.real).max()
    height = 1.1 * np.abs(curve.imag[np.abs(curve) < 2.5 * size]).max()
    axis.plot([-2.0 * size, 0.0], [0.0, 0.0], color="tab:red", lw=4, alpha=0.35, label="−1/N")
    axis.plot(curve.real, curve.imag, color="tab:blue", label="G(jω), ω > 0")
    axis.plot(curve.real, -curve.imag, ":", color="tab:blue", label="G(jω), ω < 0")
    print(f"{title}: {furuta.limit_cycle(loop).kind}")
    for cycle in furuta.predict_cycles(loop).cycles:
        crossing = g(1j * cycle.omega_rad_s).real
        axis.plot(crossing, 0.0, "o", color="black", mfc="white", zorder=3)
        print(f"   meets −1/N at {cycle.omega_rad_s:.3f} rad/s, G = {crossing:.3f} rad/(s V)")
    axis.set(xlim=(-1.3 * size, 1.1 * size), ylim=(-height, height), title=title)
    axis.set(xlabel="Re G [rad/(s V)]", ylabel="Im G [rad/(s V)]")
axes[0, 1].legend(loc="upper left")
Path("output/examples").mkdir(parents=True, exist_ok=True)
figure.savefig("output/examples/nyquist.png", dpi=110)

# prints
# a) u = 60θ + 20θ̇ + 10φ + 4φ̇: limit_cycle
#    meets −1/N at 3.057 rad/s, G = -1.714 rad/(s V)
# b) u = 60θ + 20θ̇: unbounded
# c) u = 60θ + 20θ̇ + φ̇: steady
# d) u = 60θ + 20θ̇ + 7φ̇: steady
