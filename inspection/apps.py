"""Registers the app with Django."""

from django.apps import AppConfig


class InspectionConfig(AppConfig):
    name = "inspection"
