"""Monitoring of the programs: metrics, logs and readiness. It knows no app."""
