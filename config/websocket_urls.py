"""All URLs of websockets."""

from telemetry.websocket_urls import websocket_urlpatterns as of_telemetry
from workspace.live.websocket_urls import websocket_urlpatterns as of_the_workspace

websocket_urlpatterns = [*of_telemetry, *of_the_workspace]
