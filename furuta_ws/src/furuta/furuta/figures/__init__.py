"""Figures of results, without ROS."""
