"""Registers the app with Django."""

from django.apps import AppConfig

from workspace.admin_pages.field_labels import label


class ResultsConfig(AppConfig):
    name = "results"

    def ready(self) -> None:
        label(self.get_models())
