"""Standard errors of the fitted parameters."""
