"""MAVLink side of a simulated UAV: reports, answers and commands. Pure state machines."""
