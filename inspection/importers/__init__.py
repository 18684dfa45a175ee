"""Readers of the files that infrastructure, zones and terrain come in, with their limits and faults. Pure."""
