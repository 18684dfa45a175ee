"""Simulated UAVs on real sockets, at the pace of a clock: one process flies a batch of them."""
