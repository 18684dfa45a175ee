"""Registers the app with Django, and what it asks of a mission before it is approved."""

from django.apps import AppConfig


class SimulationConfig(AppConfig):
    name = "simulation"

    def ready(self) -> None:
        from missions.approval_hooks import register_check  # noqa: PLC0415 (models are there by then)

        register_check("simulation.services.green_verdict.reasons_without_rehearsal")
