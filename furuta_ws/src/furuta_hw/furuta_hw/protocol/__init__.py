"""The frames of the bundled serial protocol."""
