"""Friction compensators and the friction observer node."""
