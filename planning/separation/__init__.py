"""UAVs that fly at the same time, kept apart in time and height."""
