"""Simulation of the closed loop without ROS."""
