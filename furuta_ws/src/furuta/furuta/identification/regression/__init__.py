"""First estimates of the model by linear regression."""
