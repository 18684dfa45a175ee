"""URLs of planning, missions and UAVs under /api/v1/."""

from django.urls import path

from missions import views
from missions.views.approvals import (
    MissionAbort,
    MissionApproval,
    MissionApprove,
    MissionClose,
    MissionDispatch,
    MissionNearestZone,
    MissionRevoke,
)
from missions.views.asset_inspections import AssetMissions, InspectedParts, InspectionsTile
from missions.views.campaigns import CampaignDaysFile, CampaignDetail, CampaignList, CampaignPlan, CampaignRoutes
from missions.views.commands import CommandDetail, MissionCommands, MissionsCommands, UavCommands
from missions.views.coverage import MissionCoverage, MissionCoverageFile
from missions.views.events import LiveEvents, MissionEvents
from missions.views.explanations import LaterDeparture, MissionExplanation, WhyRoute, WhyTarget
from missions.views.legal_windows import MissionLegalWindows, PlanLegalWindows
from missions.views.manual_edits import LegChecks, RouteWaypoints, RouteWaypointsLook, RouteWaypointsUndo
from missions.views.plans import CameraCatalogue, ReachableAssets, ViewPlans
from missions.views.replan_offers import MissionReplanOffers, ReplanOfferAccept, ReplanOfferDecline, ReplanOfferDetail
from missions.views.selections import SelectionDetail, SelectionList
from missions.views.starts import MissionPlannedStarts, MissionReturns, PlannedStartsList

urlpatterns = [
    path("plans", views.PlanList.as_view(), name="api-plans"),
    path("plans/why-target", WhyTarget.as_view(), name="api-plans-why-target"),
    path("plans/why-route", WhyRoute.as_view(), name="api-plans-why-route"),
    path("plans/later-departure", LaterDeparture.as_view(), name="api-plans-later-departure"),
    path("plans/legal-windows", PlanLegalWindows.as_view(), name="api-plans-legal-windows"),
    path("reachability", ReachableAssets.as_view(), name="api-reachability"),
    path("view-plans", ViewPlans.as_view(), name="api-view-plans"),
    path("camera-catalogue", CameraCatalogue.as_view(), name="api-camera-catalogue"),
    path("missions", views.MissionList.as_view(), name="api-missions"),
    path("missions/filters", views.MissionFilterChoices.as_view(), name="api-mission-filters"),
    path("missions/delete", views.MissionsDelete.as_view(), name="api-missions-delete"),
    path("missions/restore", views.MissionsRestore.as_view(), name="api-missions-restore"),
    path("missions/commands", MissionsCommands.as_view(), name="api-missions-commands"),
    path("missions/<uuid:mission_id>", views.MissionDetail.as_view(), name="api-mission"),
    path("missions/<uuid:mission_id>/plan", views.MissionPlan.as_view(), name="api-mission-plan"),
    path("missions/<uuid:mission_id>/proof", views.MissionProof.as_view(), name="api-mission-proof"),
    path("missions/<uuid:mission_id>/restore", views.MissionRestore.as_view(), name="api-mission-restore"),
    path("missions/<uuid:mission_id>/duplicate", views.MissionDuplicate.as_view(), name="api-mission-duplicate"),
    path("missions/<uuid:mission_id>/follow-up", views.MissionFollowUp.as_view(), name="api-mission-follow-up"),
    path("missions/<uuid:mission_id>/coverage", MissionCoverage.as_view(), name="api-mission-coverage"),
    path("missions/<uuid:mission_id>/coverage.csv", MissionCoverageFile.as_view(), name="api-mission-coverage-file"),
    path("missions/<uuid:mission_id>/presence", views.MissionPresence.as_view(), name="api-mission-presence"),
    path("missions/<uuid:mission_id>/explanation", MissionExplanation.as_view(), name="api-mission-explanation"),
    path("missions/<uuid:mission_id>/legal-windows", MissionLegalWindows.as_view(), name="api-mission-legal-windows"),
    path("missions/<uuid:mission_id>/routes/<int:uav>/waypoints", RouteWaypoints.as_view(), name="api-route-waypoints"),
    path("missions/<uuid:mission_id>/routes/<int:uav>/waypoints/look", RouteWaypointsLook.as_view(), name="api-route-waypoints-look"),
    path("missions/<uuid:mission_id>/routes/<int:uav>/waypoints/undo", RouteWaypointsUndo.as_view(), name="api-route-waypoints-undo"),
    path("missions/<uuid:mission_id>/approval", MissionApproval.as_view(), name="api-mission-approval"),
    path("missions/<uuid:mission_id>/nearest-zone", MissionNearestZone.as_view(), name="api-mission-nearest-zone"),
    path("missions/<uuid:mission_id>/approve", MissionApprove.as_view(), name="api-mission-approve"),
    path("missions/<uuid:mission_id>/revoke", MissionRevoke.as_view(), name="api-mission-revoke"),
    path("missions/<uuid:mission_id>/dispatch", MissionDispatch.as_view(), name="api-mission-dispatch"),
    path("missions/<uuid:mission_id>/abort", MissionAbort.as_view(), name="api-mission-abort"),
    path("missions/<uuid:mission_id>/close", MissionClose.as_view(), name="api-mission-close"),
    path("missions/<uuid:mission_id>/planned-starts", MissionPlannedStarts.as_view(), name="api-mission-planned-starts"),
    path("planned-starts", PlannedStartsList.as_view(), name="api-planned-starts"),
    path("missions/<uuid:mission_id>/returns", MissionReturns.as_view(), name="api-mission-returns"),
    path("missions/<uuid:mission_id>/events", MissionEvents.as_view(), name="api-mission-events"),
    path("live/events", LiveEvents.as_view(), name="api-live-events"),
    path("missions/<uuid:mission_id>/commands", MissionCommands.as_view(), name="api-mission-commands"),
    path("missions/<uuid:mission_id>/replan-offers", MissionReplanOffers.as_view(), name="api-mission-replan-offers"),
    path("replan-offers/<uuid:offer_id>", ReplanOfferDetail.as_view(), name="api-replan-offer"),
    path("replan-offers/<uuid:offer_id>/accept", ReplanOfferAccept.as_view(), name="api-replan-offer-accept"),
    path("replan-offers/<uuid:offer_id>/decline", ReplanOfferDecline.as_view(), name="api-replan-offer-decline"),
    path("leg-checks", LegChecks.as_view(), name="api-leg-checks"),
    path("missions/<uuid:mission_id>/history", views.MissionHistory.as_view(), name="api-mission-history"),
    path("campaigns", CampaignList.as_view(), name="api-campaigns"),
    path("campaigns/<uuid:campaign_id>", CampaignDetail.as_view(), name="api-campaign"),
    path("campaigns/<uuid:campaign_id>/days.csv", CampaignDaysFile.as_view(), name="api-campaign-days-file"),
    path("campaigns/<uuid:campaign_id>/routes", CampaignRoutes.as_view(), name="api-campaign-routes"),
    path("campaigns/<uuid:campaign_id>/plan", CampaignPlan.as_view(), name="api-campaign-plan"),
    path("uavs", views.UavList.as_view(), name="api-uavs"),
    path("uavs/<int:uav_id>", views.UavDetail.as_view(), name="api-uav"),
    path("uavs/<int:uav_id>/restore", views.UavRestore.as_view(), name="api-uav-restore"),
    path("uavs/<int:uav_id>/missions", views.UavMissions.as_view(), name="api-uav-missions"),
    path("uavs/<int:uav_id>/commands", UavCommands.as_view(), name="api-uav-commands"),
    path("commands/<uuid:command_id>", CommandDetail.as_view(), name="api-command"),
    path("uavs/<int:uav_id>/credentials", views.UavCredentials.as_view(), name="api-uav-credentials"),
    path("uavs/<int:uav_id>/credentials/<int:credential_id>", views.UavCredentialDetail.as_view(), name="api-uav-credential"),
    path("uav-types", views.UavTypeList.as_view(), name="api-uav-types"),
    path("uav-types/<int:type_id>", views.UavTypeDetail.as_view(), name="api-uav-type"),
    path("uav-types/<int:type_id>/restore", views.UavTypeRestore.as_view(), name="api-uav-type-restore"),
    path("bases", views.BaseList.as_view(), name="api-bases"),
    path("bases/<int:base_id>", views.BaseDetail.as_view(), name="api-base"),
    path("bases/<int:base_id>/restore", views.BaseRestore.as_view(), name="api-base-restore"),
    path("assets/<int:asset_id>/missions", AssetMissions.as_view(), name="api-asset-missions"),
    path("assets/<int:asset_id>/inspected-parts", InspectedParts.as_view(), name="api-inspected-parts"),
    path("tiles/inspections/<int:zoom>/<int:column>/<int:row>", InspectionsTile.as_view(), name="api-inspections-tile"),
    path("selections", SelectionList.as_view(), name="api-selections"),
    path("selections/<int:selection_id>", SelectionDetail.as_view(), name="api-selection"),
]
