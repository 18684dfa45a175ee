"""URLs of the pages."""

from django.urls import path

from missions.pages import FleetPage, MissionPage, MissionsPage

urlpatterns = [
    path("", MissionsPage.as_view(), name="missions"),
    path("uavs", FleetPage.as_view(), name="fleet"),
    path("missions/new", MissionPage.as_view(), name="mission-new"),
    path("missions/<uuid:mission_id>", MissionPage.as_view(), name="mission"),
    path("missions/<uuid:mission_id>/rehearse", MissionPage.as_view(stage="rehearse"), name="mission-rehearse"),
]
