"""URLs of the workspace's websockets."""

from django.urls import path

from workspace.jobs.consumers import JobConsumer

websocket_urlpatterns = [path("ws/jobs/<uuid:job_id>", JobConsumer.as_asgi())]
