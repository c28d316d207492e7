"""Bridge to a real rig: calibration, wire protocol, safety, the bridge node, and an emulated rig."""
