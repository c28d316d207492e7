"""Limit cycles by python-control's describing functions, beside the exact ones.

LuGre's describing function depends on the frequency: it is taken at the predicted one.
"""

from math import pi

import control
import numpy as np

import furuta

AMPLITUDES = np.linspace(0.3, 3.0, 20)  # of the arm's speed [rad/s]
OMEGA = np.geomspace(1.0, 10.0, 50)  # [rad/s]

for name in ("coulomb", "stribeck", "lugre"):
    loop = furuta.make_loop({"plant.friction.law": name})
    g = furuta.linearize(loop)["phi_dot", "torque"]  # equation (10)
    (predicted,) = furuta.predict_cycles(loop).cycles
    law = furuta.friction_law(name)
    friction = furuta.friction_nonlinearity(law, predicted.omega_rad_s)
    for amplitude, omega in control.describing_function_response(g, friction, AMPLITUDES, OMEGA):
        exact = furuta.limit_cycle(loop)
        print(
            f"{name}: {2.0 * amplitude / omega:.3f} rad, {2.0 * pi / omega:.2f} s; "
            f"exact {exact.phi_peak_to_peak_rad:.3f} rad, {exact.period_s:.2f} s"
        )

# prints
# coulomb: 0.643 rad, 2.07 s; exact 0.515 rad, 2.30 s
# stribeck: 0.643 rad, 2.07 s; exact 0.515 rad, 2.30 s
# lugre: 0.637 rad, 2.15 s; exact 0.511 rad, 2.37 s
