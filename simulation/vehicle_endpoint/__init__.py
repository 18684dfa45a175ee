"""Simulated UAVs on real sockets, at the speed of a clock: one process flies a batch of them."""
