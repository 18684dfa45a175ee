"""Addresses of the pages."""

from django.urls import path

from telemetry.pages import FlyPage, LivePage

urlpatterns = [
    path("live", LivePage.as_view(), name="live"),
    path("missions/<uuid:mission_id>/fly", FlyPage.as_view(), name="mission-fly"),
]
