"""Friction in the arm's joint: one file per law, :mod:`.laws` names them all."""
