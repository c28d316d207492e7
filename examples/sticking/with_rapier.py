"""Rapier: it has no dry friction of joints. A stand-in is a motor that brakes (motor)."""
