"""URLs of the pages."""

from django.urls import path
from django.views.generic import RedirectView

from missions.pages import CampaignPage, FleetPage, MissionPage, MissionsPage

urlpatterns = [
    path("", MissionsPage.as_view(), name="missions"),
    path("missions", RedirectView.as_view(pattern_name="missions", query_string=True)),
    path("map", RedirectView.as_view(pattern_name="mission-new", query_string=True)),
    path("campaigns/<uuid:campaign_id>", CampaignPage.as_view(), name="campaign"),
    path("uavs", FleetPage.as_view(), name="fleet"),
    path("missions/new", MissionPage.as_view(), name="mission-new"),
    path("missions/<uuid:mission_id>", MissionPage.as_view(), name="mission"),
    path("missions/<uuid:mission_id>/rehearse", MissionPage.as_view(stage="rehearse"), name="mission-rehearse"),
]
