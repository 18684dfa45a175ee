"""Spanwise's Celery application on a broker that takes a task for lost after some seconds, and notes in Redis of what was delivered."""

import os

from celery.signals import task_prerun
from django.conf import settings
from redis import Redis

from config.celery import app

VISIBILITY_S = 3

app.conf.broker_transport_options = settings.CELERY_BROKER_TRANSPORT_OPTIONS | {"visibility_timeout": VISIBILITY_S}


@task_prerun.connect
def note_delivery(**_: object) -> None:
    Redis.from_url(os.environ["REDIS_URL"]).incr(os.environ["SPANWISE_TEST_DELIVERIES"])
