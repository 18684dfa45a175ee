"""The HTTP application (WSGI)."""

import gc
import os

from django.core.wsgi import get_wsgi_application

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
application = get_wsgi_application()

from missions.services import warm_up  # noqa: E402 (Django first)
from operation.exposition import tell_how_it_does  # noqa: E402

tell_how_it_does("web")
warm_up()  # before the first request comes in

# What is there by now stays: the collector need not walk through graphs and models again for each few plans.
gc.collect()
gc.freeze()
