"""The robot description of the Furuta pendulum."""
