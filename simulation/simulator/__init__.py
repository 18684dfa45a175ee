"""The simulator: a process that flies simulated UAVs in real time, as many as it has taken."""
