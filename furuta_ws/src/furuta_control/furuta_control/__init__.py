"""State estimator and stabilising controller: a core and a node each."""
