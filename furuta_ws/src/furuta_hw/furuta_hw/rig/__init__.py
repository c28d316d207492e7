"""Rig files: model, calibration, line and limits of a rig."""
