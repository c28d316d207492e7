"""Many closed loops at once, in the lanes of vector instructions."""
