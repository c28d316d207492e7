"""Simulation of the closed loop without ROS, and measurement of its oscillation."""
