"""Registers the app with Django."""

from django.apps import AppConfig


class SimulationConfig(AppConfig):
    name = "simulation"
