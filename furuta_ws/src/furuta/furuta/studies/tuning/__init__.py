"""Automatic tuning of the friction compensator."""
