"""Models of the Furuta pendulum from recordings."""
