"""The HTTP application (WSGI)."""

import os

from django.core.wsgi import get_wsgi_application

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
application = get_wsgi_application()

from missions.services import warm_up  # noqa: E402 (Django first)

warm_up()  # before the first request comes in
