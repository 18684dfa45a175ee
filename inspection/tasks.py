"""Doors to the data queue: keeping the graph up to date."""

from celery import shared_task


@shared_task(time_limit=900)
def refresh_graph() -> None:
    """Build a graph if the ground has changed since the newest one."""
