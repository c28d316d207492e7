"""Parts of the simulated rig that the control system does not know; all are off by default."""
