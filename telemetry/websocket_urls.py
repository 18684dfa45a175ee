"""URLs of live pages' websockets."""

from django.urls import path

from telemetry.consumers import LiveConsumer

websocket_urlpatterns = [
    path("ws/live", LiveConsumer.as_asgi()),
    path("ws/missions/<uuid:mission_id>/live", LiveConsumer.as_asgi()),
]
