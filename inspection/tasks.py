"""Doors to the data queue: keeping the graph up to date."""

from celery import shared_task

from inspection import services


@shared_task(time_limit=900, soft_time_limit=870)
def refresh_graph() -> None:
    """Build a graph if the ground has changed since the newest one; several changes make one build."""
    services.refresh_graph()
