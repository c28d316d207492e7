"""Limit cycles predicted by describing functions."""
