"""What is done about telemetry by the clock."""

from celery import shared_task

from telemetry import services


@shared_task(time_limit=120, soft_time_limit=110)
def forget_old_telemetry() -> None:
    services.forget_old_telemetry()
