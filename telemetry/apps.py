"""Registers the app with Django, and what it tells the planner."""

from django.apps import AppConfig


class TelemetryConfig(AppConfig):
    name = "telemetry"

    def ready(self) -> None:
        from missions.in_air_hooks import register_source  # noqa: PLC0415 (models are there by then)

        register_source("telemetry.selectors.in_the_air.reported_in_the_air")
