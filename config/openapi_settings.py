"""Settings of drf-spectacular: the OpenAPI document, and one name for each list of choices that several serializers use."""

import os
from typing import Any

from config.openapi_tags import root_extensions, tags
from results.categories import BY_CODE
from workspace.api.headers import HEADERS


def _contact() -> dict[str, str]:
    """Return the contact for integrators: the administrators of this installation."""
    email = os.environ.get("SPANWISE_CONTACT_EMAIL", "")
    return {"name": "Administrators of this installation"} | ({"email": email} if email else {})


def openapi_settings() -> dict[str, Any]:
    return {
        "TITLE": "Spanwise",
        "DESCRIPTION": "Planning, rehearsing, flying and reviewing UAV inspections of power lines, bridges and railways.",
        "VERSION": "1",
        "LICENSE": {"name": "Apache-2.0", "url": "https://www.apache.org/licenses/LICENSE-2.0"},
        "CONTACT": _contact(),
        "POSTPROCESSING_HOOKS": ["drf_spectacular.hooks.postprocess_schema_enums", "workspace.api.schema.name_etags"],
        "APPEND_COMPONENTS": {"headers": HEADERS},
        "SERVE_INCLUDE_SCHEMA": False,
        "TAGS": tags(),
        "EXTENSIONS_ROOT": root_extensions(),
        "SCHEMA_PATH_PREFIX": r"/api/v1",
        "COMPONENT_SPLIT_REQUEST": True,
        "ENUM_NAME_OVERRIDES": {
            "AssetKind": "inspection.models.AssetKind",
            "ImportKind": "inspection.models.ImportKind",
            "DataIssueKind": "inspection.models.DataIssueKind",
            "WaypointKind": "missions.models.WAYPOINT_KINDS",
            "TaskKind": ["look", "photo", "hold"],
            "ViewPattern": ["detail", "overview", "spans"],
            "NotCountedReason": ["failed", "position", "height", "attitude", "tilted", "far"],
            "HeightSource": ["tag", "line", "assumed"],
            "DaylightEvent": "inspection.zones.schedule.EVENTS",
            "JobState": "workspace.models.JobState",
            "Role": "workspace.models.Role",
            "TokenScope": "workspace.models.TokenScope",
            "Theme": "workspace.models.Theme",
            "Units": "workspace.models.Units",
            "SignInOutcome": "workspace.models.SignInOutcome",
            "InvitationState": "accounts.serializers.InvitationState",
            "ProposalState": "inspection.models.ProposalState",
            "DataIssueState": "inspection.models.DataIssueState",
            "MissionState": "missions.models.MissionState",
            "OfferState": "missions.models.OfferState",
            "ReturnState": ["clear", "in_the_way", "unknown", "not_checked"],
            "AssessmentLevel": "simulation.models.AssessmentLevel",
            "SimulationState": "simulation.models.SimulationState",
            "SimulatedAutopilotType": "simulation.models.SimulatedAutopilotType",
            "AlertLevel": "telemetry.models.AlertLevel",
            "FindingState": ["open", "work_ordered", "done", "verified", "rejected"],
            "FindingCategory": list(BY_CODE),
            "ObservationOutcome": "results.models.ObservationOutcome",
            "SeveritySource": "results.models.SeveritySource",
            "MarkType": ["box", "polygon"],
            "MediumKind": "results.models.MediumKind",
            "MediumState": "results.models.MediumState",
            "Placement": "results.models.Placement",
            "Review": "results.models.Review",
            "TakenAtSource": "results.models.TakenAtSource",
            "CameraHeightReference": ["amsl", "ellipsoid", "take_off", "unknown"],
            "TargetState": "missions.models.TargetState",
            "UavState": "missions.models.UavState",
            "UavFigure": "missions.selectors.fleet.FIGURES",
            "CredentialKind": "missions.models.CredentialKind",
            "CommandKind": "missions.models.CommandKind",
            "BatchKind": ["hold", "land", "pause", "resume", "return"],
            "CommandState": "missions.models.CommandState",
            "CommandPriority": ["safety", "pause", "mission", "parameter"],
            "TargetPriority": "missions.models.TargetPriority",
            "LinkKind": "missions.models.LinkKind",
            "HeightReference": "inspection.models.HeightReference",
            "FeatureType": ["Feature"],
            "FeatureCollectionType": ["FeatureCollection"],
            "GeometryType": ["Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon"],
        },
    }
