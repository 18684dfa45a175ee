"""The HTTP application of UAVs only (WSGI), program `uav-link`: pages cannot occupy its threads, and it plans nothing."""

import os

import django
from django.conf import settings
from django.core.handlers.wsgi import WSGIHandler

from operation.tracing import begin_tracing

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
settings.ROOT_URLCONF = "config.uav_link_urls"
django.setup(set_prefix=False)  # looks for the middleware of the pages
settings.MIDDLEWARE = [
    "config.instrumentation.request_instrumentation.ObservedRequests",
    "django.middleware.security.SecurityMiddleware",
    "workspace.api.query_parameters.KnownQueryParameters",
]
begin_tracing("uav-link")  # before the middleware that it extends is built
application = WSGIHandler()

import config.uav_link_urls  # noqa: E402, F401 (Django first; before the first request comes in)
from operation.program import program_begins  # noqa: E402

program_begins("uav-link")
