"""Metrics of requests, tasks and the whole system."""
