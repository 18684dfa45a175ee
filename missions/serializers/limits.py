"""Bounds of what comes in."""

FARTHEST_RANGE_M = 1e7
FASTEST_MPS = 100.0
LARGEST_KEY = 2**63 - 1
LONGEST_UAV_NAME = 100
LONGEST_SENSOR = 100
MOST_SENSORS_OF_UAV = 13  # a type has up to twelve, and a UAV one of its own
MOST_TARGETS = 10_000  # that a UAV may be said to do at most
