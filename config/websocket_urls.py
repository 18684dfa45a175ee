"""All URLs of websockets."""

from django.urls import path

from telemetry.consumers import LiveConsumer
from workspace.jobs.consumers import JobConsumer

websocket_urlpatterns = [
    path("ws/live", LiveConsumer.as_asgi()),
    path("ws/missions/<uuid:mission_id>/live", LiveConsumer.as_asgi()),
    path("ws/jobs/<uuid:job_id>", JobConsumer.as_asgi()),
]
