"""Registers the app with Django."""

from django.apps import AppConfig


class MissionsConfig(AppConfig):
    name = "missions"
