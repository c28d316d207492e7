"""The closed loop without ROS, and what is measured on it."""
