"""Furuta pendulum and friction: pure mathematics, no ROS."""
