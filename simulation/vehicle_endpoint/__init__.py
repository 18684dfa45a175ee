"""Simulated UAVs on real sockets, paced by a clock: one process flies a fleet."""
