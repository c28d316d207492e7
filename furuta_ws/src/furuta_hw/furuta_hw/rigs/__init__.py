"""Rigs and rig files."""
