"""Bridge to a real rig. Not built yet."""
