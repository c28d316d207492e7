"""Mathematics of the Furuta pendulum and of friction, without ROS."""
