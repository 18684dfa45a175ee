"""Addresses of simulation under /api/v1/."""

from django.urls import path

from simulation.views.airframes import Airframes, RehearsalRuleView, UavTypeAirframe
from simulation.views.rehearsals import MissionRehearsals, RehearsalCancel, RehearsalDetail, RehearsalTrackOfRun

urlpatterns = [
    path("missions/<uuid:mission_id>/rehearsals", MissionRehearsals.as_view(), name="api-rehearsals"),
    path("missions/<uuid:mission_id>/rehearsals/<uuid:rehearsal_id>", RehearsalDetail.as_view(), name="api-rehearsal"),
    path("missions/<uuid:mission_id>/rehearsals/<uuid:rehearsal_id>/track", RehearsalTrackOfRun.as_view(), name="api-rehearsal-track"),
    path("missions/<uuid:mission_id>/rehearsals/<uuid:rehearsal_id>/cancel", RehearsalCancel.as_view(), name="api-rehearsal-cancel"),
    path("airframes", Airframes.as_view(), name="api-airframes"),
    path("uav-types/<int:type_id>/airframe", UavTypeAirframe.as_view(), name="api-uav-type-airframe"),
    path("rehearsal-rule", RehearsalRuleView.as_view(), name="api-rehearsal-rule"),
]
