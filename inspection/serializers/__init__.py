"""Shapes of map data in the API."""
