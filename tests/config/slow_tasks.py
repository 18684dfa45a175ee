"""A Celery application with the settings of Spanwise's own, and a task that takes as long as it is told. Notes go to a list in Redis."""

import os
import time
from contextlib import suppress

from celery import Celery
from celery.signals import worker_process_init
from redis import Redis

from config.celery import warm_up_process
from config.worker_shutdown import SoftEnd

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
worker_process_init.disconnect(warm_up_process)  # nothing is planned here
app = Celery("slow")
app.config_from_object("django.conf:settings", namespace="CELERY")
app.conf.task_default_queue = os.environ["SLOW_QUEUE"]
app.conf.task_routes = {}
app.steps["worker"].add(SoftEnd)


def note(word: str) -> None:
    Redis.from_url(os.environ["REDIS_URL"]).rpush(f"{os.environ['SLOW_QUEUE']}.notes", word)


@worker_process_init.connect
def warm_up(**_: object) -> None:
    """As long as a test wants a process to."""
    note("warms up")
    time.sleep(float(os.environ.get("SLOW_WARM_UP_S", "0")))


@app.task
def take(seconds: float) -> None:
    note("began")
    time.sleep(seconds)
    note("done")


@app.task
def take_and_receive_nothing(seconds: float) -> None:
    """As work in a library that swallows whatever is raised in it."""
    note("began")
    end_s = time.monotonic() + seconds
    while time.monotonic() < end_s:
        with suppress(BaseException):
            time.sleep(seconds)
