"""A friction observer of my own."""
