"""Registers the app with Django, and what it asks of a mission before it is approved."""

from django.apps import AppConfig


class SimulationConfig(AppConfig):
    name = "simulation"

    def ready(self) -> None:
        from missions.services.approval_checks import register_check  # noqa: PLC0415 (models are there by then)
        from simulation.services.green_verdict import reasons_without_rehearsal  # noqa: PLC0415

        register_check(reasons_without_rehearsal)
