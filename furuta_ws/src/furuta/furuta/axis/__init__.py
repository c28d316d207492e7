"""One axis with friction under a servo controller: cycles, compensation, identification."""
