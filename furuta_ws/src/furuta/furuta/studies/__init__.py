"""Studies on many loops: experiments, tuning, sweeps, comparisons, maps."""
