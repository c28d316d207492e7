"""Commissioning: zeros, signs and friction of a rig."""

RAMP_RATE = 0.05  # of the voltage, while friction is measured [V/s]
