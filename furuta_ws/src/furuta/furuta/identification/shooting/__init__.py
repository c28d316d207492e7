"""The model simulated along a recording, in segments."""
