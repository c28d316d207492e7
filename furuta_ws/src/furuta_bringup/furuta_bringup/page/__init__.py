"""The live view of the graph in a browser."""
