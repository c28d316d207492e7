"""Swing-up: random starts, optimised trajectories, and the criteria of a competition."""
