"""Bag files: written, read and recovered, without ROS."""
