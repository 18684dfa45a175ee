"""Least-cost paths on a built graph."""
