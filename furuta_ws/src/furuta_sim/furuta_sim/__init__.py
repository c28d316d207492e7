"""Simulated rig: core in ``plant``, node in ``plant_node``."""
