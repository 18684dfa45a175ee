"""Shapes of the ground in the API."""
