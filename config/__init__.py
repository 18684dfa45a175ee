"""The composition root: settings, URLs, servers. It knows every app, and no app knows it."""

from config.celery import app as celery_app
from config.compiled.compiled_core import use_compiled_directory
from operation.garbage_collection import collect_rarely

collect_rarely()
use_compiled_directory()

__all__ = ["celery_app"]
