"""The node hardware_bridge."""
