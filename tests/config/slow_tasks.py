"""A Celery application with the settings of Spanwise's own, and a task that takes as long as it is told. Notes go to a list in Redis."""

import os
import time

from celery import Celery
from celery.signals import worker_process_init
from redis import Redis

from config.celery import warm_up_process

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
worker_process_init.disconnect(warm_up_process)  # nothing is planned here
app = Celery("slow")
app.config_from_object("django.conf:settings", namespace="CELERY")
app.conf.task_default_queue = os.environ["SLOW_QUEUE"]
app.conf.task_routes = {}


@app.task
def take(seconds: float) -> None:
    notes = Redis.from_url(os.environ["REDIS_URL"])
    notes.rpush(f"{os.environ['SLOW_QUEUE']}.notes", "began")
    time.sleep(seconds)
    notes.rpush(f"{os.environ['SLOW_QUEUE']}.notes", "done")
