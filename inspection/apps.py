"""Django app configuration."""

from django.apps import AppConfig

from workspace.admin_pages.field_labels import label


class InspectionConfig(AppConfig):
    name = "inspection"

    def ready(self) -> None:
        label(self.get_models())
