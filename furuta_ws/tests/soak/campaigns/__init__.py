"""The campaigns of the soak, one module each."""
