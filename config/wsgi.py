"""The HTTP application (WSGI)."""

import os

from django.core.wsgi import get_wsgi_application

from operation.tracing import begin_tracing

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
begin_tracing("web")  # before the middleware is put together, of which it is a part
application = get_wsgi_application()

from missions.services import warm_up  # noqa: E402 (Django first)
from operation.garbage import keep_what_is_there  # noqa: E402
from operation.program import program_begins  # noqa: E402

program_begins("web")
warm_up()  # before the first request comes in
keep_what_is_there()
