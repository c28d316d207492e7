"""The node graph: its description, its parameters, and how it is started."""
