"""Alerts: opened and closed with their cause, acknowledged and noted by users."""
