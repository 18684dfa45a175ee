"""Shapes of missions, plans and UAVs in the API."""
