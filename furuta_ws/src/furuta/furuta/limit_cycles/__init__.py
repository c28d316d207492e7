"""Exact periodic motions of the ideal loop."""
