"""Recordings brought to one set of units, signs and zeros."""
