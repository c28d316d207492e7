"""Swing-up: random starts, pushes, optimised trajectories."""
