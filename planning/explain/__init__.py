"""Explanations of a finished plan: of routes, of shortfalls of energy, of what keeps other UAVs from a target."""
