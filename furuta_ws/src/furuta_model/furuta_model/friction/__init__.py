"""Friction in the arm's joint; :mod:`.laws` lists the laws."""
