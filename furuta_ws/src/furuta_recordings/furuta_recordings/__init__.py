"""Recordings: bags written, read, repaired and replayed, and readers for other formats."""
