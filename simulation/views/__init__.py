"""Doors of simulation to the API."""
