"""The websocket application (ASGI), program `live`. HTTP is config/wsgi.py's: Django under ASGI costs many times the processor time."""

import os

from django.core.asgi import get_asgi_application

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
get_asgi_application()  # loads the apps before models are imported below

from channels.routing import ProtocolTypeRouter, URLRouter  # noqa: E402
from channels.sessions import SessionMiddlewareStack  # noqa: E402

from config.live import OriginCheck, SaysGoodbye, probed_or_upgrade_required  # noqa: E402
from config.websocket_urls import websocket_urlpatterns  # noqa: E402
from operation.program import program_begins  # noqa: E402

program_begins("live")
application = SaysGoodbye(
    ProtocolTypeRouter(
        {
            "http": probed_or_upgrade_required,
            "websocket": OriginCheck(SessionMiddlewareStack(URLRouter(websocket_urlpatterns))),
        }
    )
)
