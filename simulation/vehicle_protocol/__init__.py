"""The MAVLink side of a simulated UAV: what it tells, what it answers and what it does when told. Pure state machines."""
