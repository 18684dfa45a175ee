"""Registers the app with Django."""

from django.apps import AppConfig


class WorkspaceConfig(AppConfig):
    name = "workspace"
