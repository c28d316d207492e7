"""Figures of results, drawn without a screen and without ROS."""

import matplotlib

matplotlib.use("Agg")
