"""Friction compensators, one file each; :mod:`furuta_friction.compensation` lists them."""
