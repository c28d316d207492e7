"""From a fitted model to a rig: its values, their uncertainty, its sensors."""
