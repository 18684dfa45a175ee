"""URLs of the UAV link under /api/v1/uav-link/."""

from django.urls import path

from telemetry.views.uav_link import UavAcknowledgements, UavCaptures, UavResults, UavRoute, UavTelemetry

urlpatterns = [
    path("route", UavRoute.as_view(), name="uav-link-route"),
    path("acknowledgements", UavAcknowledgements.as_view(), name="uav-link-acknowledgements"),
    path("telemetry", UavTelemetry.as_view(), name="uav-link-telemetry"),
    path("captures", UavCaptures.as_view(), name="uav-link-captures"),
    path("results", UavResults.as_view(), name="uav-link-results"),
]
