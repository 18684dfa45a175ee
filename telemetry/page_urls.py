"""URLs of the live, flight and report pages."""

from django.urls import path

from telemetry.pages import LivePage, MissionFlyPage, MissionReportPage, MissionScenePage

urlpatterns = [
    path("live", LivePage.as_view(), name="live"),
    path("missions/<uuid:mission_id>/fly", MissionFlyPage.as_view(), name="mission-fly"),
    path("missions/<uuid:mission_id>/3d", MissionScenePage.as_view(), name="mission-3d"),
    path("missions/<uuid:mission_id>/report", MissionReportPage.as_view(), name="mission-report"),
]
