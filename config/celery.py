"""The Celery application: queues `data` (imports, graph), `planning` (large plans) and `simulation` (rehearsals)."""

import os

from celery import Celery
from celery.signals import worker_process_init

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
app = Celery("spanwise")
app.config_from_object("django.conf:settings", namespace="CELERY")
app.autodiscover_tasks()


MAKES_NO_PLANS = {"simulation"}


@worker_process_init.connect
def warm_up_process(**_: object) -> None:
    """A worker's process loads what plans are made with before it takes a task, unless its queues bring it none."""
    if set(app.amqp.queues.consume_from) <= MAKES_NO_PLANS:
        return
    from missions.services import warm_up  # noqa: PLC0415 (Django is set up by then, not when this module is read)

    warm_up()
