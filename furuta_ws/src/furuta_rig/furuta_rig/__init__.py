"""A rig: its calibration and model, its serial protocol, and an emulation of it."""
