"""Standard errors, and how well a model predicts."""
