"""Addresses of the UAV link and of the log under /api/v1/."""

from django.urls import path

from telemetry.views.uav_link import UavResults, UavTelemetry

urlpatterns = [
    path("uav-link/telemetry", UavTelemetry.as_view(), name="uav-link-telemetry"),
    path("uav-link/results", UavResults.as_view(), name="uav-link-results"),
]
