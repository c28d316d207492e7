"""Friction in the arm's joint; :mod:`.laws` is the registry of the laws."""
