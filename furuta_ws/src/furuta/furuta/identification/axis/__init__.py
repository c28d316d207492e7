"""Identifies a single axis: friction that truly sticks, and errors by segments."""
