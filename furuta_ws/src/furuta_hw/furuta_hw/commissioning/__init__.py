"""Commissioning: zeros, signs and friction of a rig."""
