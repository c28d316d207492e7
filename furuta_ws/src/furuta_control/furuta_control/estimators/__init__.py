"""State estimators: one file per method; :mod:`furuta_control.estimation` lists them."""
