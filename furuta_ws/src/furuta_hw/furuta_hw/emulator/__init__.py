"""The emulated rig: reference firmware, simulated pendulum and faults."""
