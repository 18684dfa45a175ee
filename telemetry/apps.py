"""Registers the app with Django, and its data on UAVs and its checks before approval with missions."""

from django.apps import AppConfig

from workspace.admin_pages.field_labels import label


class TelemetryConfig(AppConfig):
    name = "telemetry"

    def ready(self) -> None:
        label(self.get_models())
        from missions.hooks.approval import register_check, register_start_check  # noqa: PLC0415 (models are loaded by then)
        from missions.hooks.events import register_sources  # noqa: PLC0415
        from missions.hooks.flights import register_flight_teller  # noqa: PLC0415
        from missions.hooks.in_air import (  # noqa: PLC0415
            register_down_source,
            register_ground_source,
            register_never_connected_source,
            register_source,
        )
        from missions.hooks.taken_photos import register_achieved_photos  # noqa: PLC0415

        register_achieved_photos("telemetry.selectors.captures.achieved_photos")
        register_sources("telemetry.selectors.events.SOURCES")
        register_flight_teller("telemetry.selectors.in_flight.is_in_flight")
        register_source("telemetry.selectors.in_the_air.places_in_the_air")
        register_ground_source("telemetry.selectors.in_the_air.reported_on_the_ground")
        register_never_connected_source("telemetry.selectors.in_the_air.never_connected")
        register_down_source("telemetry.selectors.in_the_air.down_off_plan")
        register_check("telemetry.services.links.approved_vehicles.reasons_of_vehicles")
        register_start_check("telemetry.services.preflight.reasons_not_ready")
