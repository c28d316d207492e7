"""Hardware bridge of the Furuta pendulum: rig files, drivers, safety, node and emulated rig."""
