"""Tasks of media."""

from celery import shared_task

from results.services.reading import read_waiting
from results.services.uploads import forget_old_uploads

READING_BUDGET_S = 20.0  # after which the queue's other work has its turn


@shared_task(time_limit=180, soft_time_limit=170)
def read_media() -> None:
    """Read what waits; the schedule starts it, and it starts itself again while more waits."""
    if read_waiting(budget_s=READING_BUDGET_S):
        read_media.delay()


@shared_task(time_limit=120, soft_time_limit=110)
def forget_old_media_uploads() -> None:
    forget_old_uploads()
