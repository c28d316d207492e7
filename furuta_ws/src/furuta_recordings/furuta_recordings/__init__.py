"""Recordings: bags written, read, recovered and replayed, and readers for other formats."""
