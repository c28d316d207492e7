"""The model simulated against a recording, in segments."""
