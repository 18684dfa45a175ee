"""The Celery application: queues `data` (imports, graph) and `planning` (large plans)."""

import os

from celery import Celery

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
app = Celery("spanwise")
app.config_from_object("django.conf:settings", namespace="CELERY")
app.autodiscover_tasks()
