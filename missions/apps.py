"""Registers the app with Django."""

from django.apps import AppConfig

from workspace.admin_pages.field_labels import label


class MissionsConfig(AppConfig):
    name = "missions"

    def ready(self) -> None:
        label(self.get_models())
        from inspection.auto_apply_hooks import register_check  # noqa: PLC0415 (models are there by then)

        register_check("missions.selectors.flown_infrastructure.flown_missions_touched")
