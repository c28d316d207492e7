"""Friction compensators: one file each, :mod:`furuta_friction.compensation` names them all."""
