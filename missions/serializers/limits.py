"""Bounds of what comes in."""

FARTHEST_RANGE_M = 1e7
FASTEST_MPS = 100.0
LARGEST_KEY = 2**63 - 1
LONGEST_UAV_NAME = 100
LONGEST_SENSOR = 100
MOST_SENSORS_OF_UAV = 13  # a type has up to twelve, and a UAV one of its own
MOST_TARGETS = 10_000  # that a UAV may be said to do at most
LARGEST_POWER_W = 1e6
HIGHEST_WIND_M = 1_000.0
STRONGEST_WIND_MPS = 60.0
MOST_WIND_LAYERS = 10
MOST_DAYS_AHEAD = 730
MOST_SORTIES = 20
MOST_RALLY_POINTS = 50
SHORTEST_LEG_M, LONGEST_LEG_M = 50.0, 5_000.0  # that legs may be divided to
LEAST_CHARGING_W = 20.0  # what a UAV takes while it stands is less
