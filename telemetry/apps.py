"""Registers the app with Django, and what it asks of a mission before it is approved."""

from django.apps import AppConfig


class TelemetryConfig(AppConfig):
    name = "telemetry"

    def ready(self) -> None:
        from missions.approval_hooks import register_check  # noqa: PLC0415 (models are there by then)

        register_check("telemetry.services.approved_vehicles.reasons_of_vehicles")
