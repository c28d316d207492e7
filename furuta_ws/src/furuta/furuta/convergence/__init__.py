"""Convergence of the friction observer: passivity conditions."""
