"""Studies on many loops: tuning, sweeps, comparisons, maps."""
