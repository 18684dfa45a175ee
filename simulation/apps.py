"""Registers the app with Django, its checks before approval, and its event sources."""

from django.apps import AppConfig

from workspace.admin_pages.field_labels import label


class SimulationConfig(AppConfig):
    name = "simulation"

    def ready(self) -> None:
        label(self.get_models())
        from missions.hooks.approval import register_check  # noqa: PLC0415 (models are loaded by then)
        from missions.hooks.events import register_sources  # noqa: PLC0415
        from missions.hooks.rehearsals import register_failed_rehearsals  # noqa: PLC0415
        from missions.hooks.taken_photos import register_rehearsed_photos  # noqa: PLC0415

        register_failed_rehearsals("simulation.services.rehearsals.failed_rehearsals")
        register_rehearsed_photos("simulation.services.rehearsed_photos.rehearsed_photos")
        register_check("simulation.services.rehearsals.reasons_without_rehearsal")
        register_sources("simulation.selectors.EVENT_SOURCES")
