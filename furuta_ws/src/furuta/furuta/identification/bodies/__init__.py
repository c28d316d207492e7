"""Bodies that are identified: how each moves, and what is unknown of it."""
