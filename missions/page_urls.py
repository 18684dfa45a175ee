"""Addresses of the pages."""

from django.contrib.auth.views import LogoutView
from django.urls import path

from missions.pages import FleetPage, MissionPage, MissionsPage, SignInPage

urlpatterns = [
    path("sign-in", SignInPage.as_view(), name="sign-in"),
    path("sign-out", LogoutView.as_view(), name="sign-out"),
    path("", MissionsPage.as_view(), name="missions"),
    path("uavs", FleetPage.as_view(), name="fleet"),
    path("missions/new", MissionPage.as_view(), name="mission-new"),
    path("missions/<uuid:mission_id>", MissionPage.as_view(), name="mission"),
]
