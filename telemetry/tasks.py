"""Periodic tasks of telemetry."""

from celery import shared_task

from telemetry import services
from telemetry.services.alerts import command_alerts
from telemetry.services.targets_checked import store_missing_visits


@shared_task(time_limit=120, soft_time_limit=110)
def forget_old_telemetry() -> None:
    services.forget_old_telemetry()


@shared_task(time_limit=30, soft_time_limit=25)
def settle_command_alerts() -> None:
    command_alerts.settle_command_alerts()


@shared_task(time_limit=300, soft_time_limit=290)
def store_visits() -> None:
    store_missing_visits()
