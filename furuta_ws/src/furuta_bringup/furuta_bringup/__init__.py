"""Launch file, configuration and executables of the whole graph."""
