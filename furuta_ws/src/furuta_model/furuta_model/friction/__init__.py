"""Friction in the arm's joint: one file per law; :mod:`.laws` is the registry."""
