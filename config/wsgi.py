"""The HTTP application (WSGI)."""

import os

from django.core.wsgi import get_wsgi_application

from operation.tracing import begin_tracing

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
begin_tracing("web")  # before the middleware that it extends is built
application = get_wsgi_application()

import config.urls  # noqa: E402, F401 (Django first; before the first request comes in)
from config.compiled.warming import warm_up_beside, warming_faults  # noqa: E402
from missions.services import warm_up  # noqa: E402
from operation.garbage_collection import freeze_startup_objects  # noqa: E402
from operation.program import program_begins  # noqa: E402
from operation.readiness import database_faults, redis_faults  # noqa: E402


def _warm_up() -> None:
    warm_up()
    freeze_startup_objects()


program_begins("web", database_faults, redis_faults, warming_faults)
warm_up_beside(_warm_up)
