"""Model and friction of a rig from a recording, with standard errors.

    tools/in_environment python examples/identify_recording.py [FILE]

FILE is a CSV table or a bag of your rig. Without it the script first records a simulated rig, whose
controller adds a multisine to the command: the limit cycle alone would not show the inertia.
"""

import sys
from pathlib import Path

import furuta
from furuta.results import Series

TRUE = {"plant.friction.alpha0": 0.25, "plant.friction.viscous": 0.02}
EXCITATION = {"kind": "multisine", "amplitude": 1.0, "period": 4.0}
COLUMNS = (
    *("time_s", "command_v", "measured_phi_rad", "measured_phi_dot_rad_s", "measured_theta_rad"),
)

if sys.argv[1:]:
    recording, zero = furuta.read_recording(sys.argv[1]), "auto"
else:
    rig = furuta.make_loop(TRUE | {f"excitation.{name}": each for name, each in EXCITATION.items()})
    series = furuta.simulate(rig, 8.0).series()
    log = Path("output/examples/log.csv")
    log.parent.mkdir(parents=True, exist_ok=True)
    Series({name: series[name] for name in COLUMNS}).write(log)
    recording, zero = furuta.read_recording(log), "upright"

found = furuta.identify(recording, furuta.PendulumBody(zero=zero)).to_dict()
for name in ("alpha", "beta", "gamma", "delta", "coulomb", "viscous"):
    print(f"{name} {found[name]:.5f} ± {found['standard_errors'][name]:.5f}")

# prints
# alpha 0.02830 ± 0.00004
# beta 0.01464 ± 0.00015
# gamma 0.00943 ± 0.00009
# delta 0.37917 ± 0.00380
# coulomb 0.24994 ± 0.00019
# viscous 0.01997 ± 0.00010
