"""Checks of finished routes, and the constraints that they add for the next candidate plan."""
