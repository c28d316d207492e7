"""Rig drivers: one module, or one package, for each protocol."""
