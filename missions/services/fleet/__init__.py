"""UAV types, bases, UAVs and their credentials."""
