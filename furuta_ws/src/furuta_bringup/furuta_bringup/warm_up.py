"""Compile everything once, so that the first run of a node or verb finds it in the cache."""

from __future__ import annotations

import rclpy

from furuta_analysis.closed_loop import Loop, simulate

from .graph import Graph
from .settings import NODES

if __name__ == "__main__":
    simulate(Loop(), 0.01)
    rclpy.init()
    Graph({node: {} for node in NODES}).close()
    rclpy.shutdown()
