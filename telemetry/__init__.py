"""The UAV link, the flight log, and what is derived from both: estimates, alerts and reports."""

from telemetry import reasons as reasons
