"""Lists of mission items, fences and rally points brought onto a vehicle and read back, as state machines."""
