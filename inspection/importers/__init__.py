"""Readers of infrastructure, zone and terrain files, with their limits and faults. Pure."""
