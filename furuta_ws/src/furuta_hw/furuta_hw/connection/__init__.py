"""The interface of rig drivers, and the connection that keeps one running."""
