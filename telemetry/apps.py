"""Registers the app with Django, and with the missions what it knows of UAVs."""

from django.apps import AppConfig


class TelemetryConfig(AppConfig):
    name = "telemetry"

    def ready(self) -> None:
        from missions.flight_hooks import register_flight_teller  # noqa: PLC0415 (models are there by then)

        register_flight_teller("telemetry.selectors.in_flight.is_in_flight")
