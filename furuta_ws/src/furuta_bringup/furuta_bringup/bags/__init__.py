"""Bags: recorded, read, mended, replayed, computed again."""
