"""Simulated rig: core in ``rig``, node in ``plant_node``."""
