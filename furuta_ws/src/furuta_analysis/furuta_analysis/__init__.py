"""Simulation and analysis of the closed loop, without ROS."""
