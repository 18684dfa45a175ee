"""A simulated UAV, advanced in steps: aircraft, autopilot and mission, wind, battery and faults."""
