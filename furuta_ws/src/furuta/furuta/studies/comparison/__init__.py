"""Comparison of compensators on simulated rigs whose true friction they do not know."""
