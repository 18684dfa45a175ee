"""Flies all routes of a mission at full speed: conditions, airframes, and lock-step time."""
