"""Estimates of a UAV's position between two reports, with their bounds."""
