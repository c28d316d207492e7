"""Settings of a loop: nodes, parameters by name, rigs."""
