"""State estimator and controller: a core and a node each."""
