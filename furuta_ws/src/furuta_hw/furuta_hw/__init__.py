"""Bridge to a real rig: calibration, wire protocol, safety, node, and a rig in software."""
