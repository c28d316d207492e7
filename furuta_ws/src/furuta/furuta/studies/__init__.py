"""Studies on many loops: experiments, tuning, sweeps, maps, sensitivity."""
