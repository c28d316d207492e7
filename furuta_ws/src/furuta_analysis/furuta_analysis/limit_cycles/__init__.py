"""The exact periodic motion of the ideal loop."""
