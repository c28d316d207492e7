"""Recordings brought to the same units, signs and zeros."""
