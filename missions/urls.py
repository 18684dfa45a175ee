"""Addresses of planning, missions and UAVs under /api/v1/."""

from django.urls import path

from missions import views

urlpatterns = [
    path("plans", views.PlanList.as_view(), name="api-plans"),
    path("missions", views.MissionList.as_view(), name="api-missions"),
    path("missions/<uuid:mission_id>", views.MissionDetail.as_view(), name="api-mission"),
    path("missions/<uuid:mission_id>/plan", views.MissionPlan.as_view(), name="api-mission-plan"),
    path("missions/<uuid:mission_id>/restore", views.MissionRestore.as_view(), name="api-mission-restore"),
    path("missions/<uuid:mission_id>/history", views.MissionHistory.as_view(), name="api-mission-history"),
    path("uavs", views.UavList.as_view(), name="api-uavs"),
    path("uavs/<int:uav_id>", views.UavDetail.as_view(), name="api-uav"),
]
