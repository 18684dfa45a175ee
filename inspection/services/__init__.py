"""Writes of the ground: what the other apps, commands and tasks call."""

from inspection.services.ground import mark_ground_changed

__all__ = ["mark_ground_changed"]
