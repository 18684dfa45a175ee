"""Limits of request values."""

MAX_RANGE_M = 1e7
MAX_SPEED_MPS = 100.0
MAX_KEY = 2**63 - 1
MAX_UAV_NAME_LENGTH = 100
MAX_SENSOR_LENGTH = 100
MAX_SENSORS_OF_UAV = 13  # a type has up to twelve, and a UAV one of its own
MAX_TARGETS = 10_000  # largest target limit of a UAV
MAX_POWER_W = 1e6
MAX_WIND_M = 1_000.0
MAX_WIND_MPS = 60.0
MAX_WIND_LAYERS = 10
MAX_DAYS_AHEAD = 730
MAX_SORTIES = 20
MAX_RALLY_POINTS = 50
MIN_LEG_M, MAX_LEG_M = 50.0, 5_000.0  # leg lengths to divide into
MIN_CHARGING_W = 20.0  # an idle UAV uses less
