"""Bag files: written, read and repaired, without ROS."""
