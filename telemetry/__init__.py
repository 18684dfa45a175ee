"""What happens in the air: the UAV link, the log, and what it says."""

from telemetry import reasons as reasons
