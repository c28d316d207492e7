"""Soak: random messages, parameters, kills and faults against the graph, checked by oracles."""
