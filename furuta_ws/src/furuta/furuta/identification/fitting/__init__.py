"""The fit of the model to recordings."""
