"""The HTTP application (WSGI)."""

import gc
import os

from django.core.wsgi import get_wsgi_application

from operation.tracing import begin_tracing

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
begin_tracing("web")  # before the middleware is put together, of which it is a part
application = get_wsgi_application()

from missions.services import warm_up  # noqa: E402 (Django first)
from operation.program import program_begins  # noqa: E402

program_begins("web")
warm_up()  # before the first request comes in

# What is there by now stays: the collector need not walk through graphs and models again for each few plans.
gc.collect()
gc.freeze()
