"""Alerts: opened with their cause, closed with it, acknowledged and noted by users."""
