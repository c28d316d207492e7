"""The live view of the graph and of recordings in a browser."""
