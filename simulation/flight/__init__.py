"""A simulated UAV, step by step: the aircraft, its autopilot and mission executive, wind, battery and faults."""
